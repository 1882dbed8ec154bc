# SPDX-License-Identifier: GPL-3.0-or-later
"""Root file systems of Debian, made once by mmdebstrap, and commands that run in them."""
import os
import pathlib
import shutil
import subprocess

SOURCE = pathlib.Path(__file__).resolve().parents[2]
ROOTS = pathlib.Path(os.environ.get("SCANMILL_PACKAGE_ROOTS", SOURCE / "build/packages/roots"))
CHROOT = shutil.which("chroot") or "/usr/sbin/chroot"
PATH = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"


def shell(command: str) -> None:
    subprocess.run(["bash", "-euc", command], check=True)


class Root:
    """A fresh copy of a Debian `suite` with `packages`."""

    def __init__(self, name: str, suite: str, packages: str = ""):
        archive = ROOTS / f"{name}.tar"
        self.path = ROOTS / name
        ROOTS.mkdir(parents=True, exist_ok=True)
        if not archive.exists():
            include = [f"--include={packages}"] if packages else []
            subprocess.run(["mmdebstrap", "--quiet", "--variant=minbase", *include, suite, str(archive)], check=True)
        self.close()
        self.path.mkdir()
        subprocess.run(["tar", "-xf", archive, "-C", self.path, "--exclude=./dev/*"], check=True)
        shell(f"mount -t proc proc '{self.path}/proc'; mount --rbind /dev '{self.path}/dev'")
        # As this machine reaches Debian's archive.
        shell(f"cp /etc/resolv.conf /etc/hosts '{self.path}/etc/'; cp -r /etc/apt/apt.conf.d/. '{self.path}/etc/apt/apt.conf.d/'")
        (self.path / "etc/apt/apt.conf.d/docker-clean").unlink(missing_ok=True)
        shell(f"mkdir -p '{self.path}/etc/ssl/certs'; cp -L /etc/ssl/certs/ca-certificates.crt '{self.path}/etc/ssl/certs/'")

    def close(self) -> None:
        """Removes the copy, with what is mounted below it."""
        for line in reversed(pathlib.Path("/proc/self/mounts").read_text().splitlines()):
            if line.split()[1].startswith(f"{self.path}/"):
                subprocess.run(["umount", "-l", line.split()[1]], check=True)
        shutil.rmtree(self.path, ignore_errors=True)

    def run(self, command: str, environment: dict[str, str] | None = None, user: str = "0:0") -> subprocess.CompletedProcess:
        """Runs the command in bash; without `environment`, HOME is /root."""
        variables = {"PATH": PATH, "LANG": "C.UTF-8", **({"HOME": "/root"} if environment is None else environment)}
        return subprocess.run(
            [CHROOT, f"--userspec={user}", self.path, "/bin/bash", "-c", command],
            env=variables, capture_output=True, text=True, check=False)

    def must(self, command: str, **options) -> str:
        """The output of a command that has to succeed."""
        done = self.run(command, **options)
        if done.returncode != 0:
            raise AssertionError(f"{command}\nended with {done.returncode}\n{done.stdout}{done.stderr}")
        return done.stdout

    def put(self, file: pathlib.Path, folder: str) -> None:
        (self.path / folder.lstrip("/")).mkdir(parents=True, exist_ok=True)
        shutil.copy(file, self.path / folder.lstrip("/"))

    def milliseconds(self, command: str, repeats: int = 20) -> list[float]:
        """The sorted durations of the command, measured by bash in the root."""
        loop = (f"for i in $(seq {repeats}); do begin=$EPOCHREALTIME; {command} >/dev/null; end=$EPOCHREALTIME; "
                "echo $((${end/./} - ${begin/./})); done")
        return sorted(int(line) / 1000 for line in self.must(loop).split())
