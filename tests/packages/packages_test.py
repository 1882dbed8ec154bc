# SPDX-License-Identifier: GPL-3.0-or-later
"""The wheel, the .deb and the image in dist/, in systems without compilers and without Scanmill's sources."""
import hashlib
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
from typing import ClassVar

from guide import Guide
from roots import SOURCE, Root, shell

sys.path[:0] = [str(SOURCE / "packaging"), str(SOURCE / "packaging/wheel")]
from build import pack, unpack

BUILD = SOURCE / "build/release"
DATA = SOURCE / "build/data"
DIST = SOURCE / "dist"
#: Times are measured again while the machine does other work.
ROUNDS = 10
INSTALL = "pip install --no-index --disable-pip-version-check --root-user-action=ignore"


def the_only(pattern: str) -> pathlib.Path:
    files = list(DIST.glob(pattern))
    if len(files) != 1:
        raise AssertionError(f"dist/ has {len(files)} files {pattern}; expected 1: run make wheel deb image")
    return files[0]


def version() -> str:
    return subprocess.run([BUILD / "bin/scanmill", "--version"], capture_output=True, text=True, check=True).stdout.split()[1]


def print_figure(text: str) -> None:
    print(f"    {text}", file=sys.stderr, flush=True)


#: Runs of ready workflows by name: the arguments after `run`.
RUNS = {"quickstart": "quickstart {scans}/kitten.xyz {scans}/ball.ply", "raw-scans": "raw-scans {scans}/lion-default.ply"}


def hashes(folder: pathlib.Path) -> dict[str, str]:
    """The hash of every mesh and picture below the folder."""
    return {
        file.name: hashlib.sha256(file.read_bytes()).hexdigest()
        for file in sorted(folder.rglob("*")) if file.suffix in (".stl", ".ply", ".png")
    }


class Expected:
    """Scans, and what the source build makes of them."""

    scans: pathlib.Path
    results: ClassVar[dict[str, dict[str, str]]] = {}

    @classmethod
    def make(cls) -> None:
        if cls.results:
            return
        work = SOURCE / "build/packages/expected"
        shutil.rmtree(work, ignore_errors=True)
        cls.scans = work / "scans"
        cls.scans.mkdir(parents=True)
        for scan in ("points_3/kitten.xyz", "points_3/ball.ply"):
            shutil.copy(DATA / scan, cls.scans)
        shutil.copy(DATA / "meshes/ChineseDragon-10kv.off", work / "lion.off")
        program = f"cd '{work}'; '{BUILD}/bin/scanmill' run"
        shell(f"{program} virtual-scans lion.off --set 'noise=0.15 %diag' -o views --no-cache -q >/dev/null")
        shutil.copy(work / "views/lion-default.ply", cls.scans)
        for name, arguments in RUNS.items():
            shell(f"{program} {arguments.format(scans='scans')} -o {name} --no-cache --picture -q >/dev/null")
            cls.results[name] = hashes(work / name)
            assert cls.results[name]


def check_without_home(test: "Package", command: str) -> None:
    """Another user runs the command without HOME: with a warning, and without one if the cache has a folder."""
    for option, warns in (("", True), ("--no-cache", False), ("--cache /free/cache", False)):
        done = test.root.run(f"rm -rf /free/out; cd /free && {command} run quickstart /scans/kitten.xyz -o out -q {option}",
                             environment={}, user="1234:1234")
        test.assertEqual(done.returncode, 0, done.stderr)
        test.assertEqual("there is no folder for the cache: neither XDG_CACHE_HOME nor HOME is an absolute path" in done.stderr, warns)


class Package(unittest.TestCase):
    root: Root
    command: str

    @classmethod
    def tearDownClass(cls) -> None:
        cls.root.close()

    def check_results(self, command: str, root: Root | None = None) -> None:
        """The ready workflows give the bytes that the source build gives."""
        root = root or self.root
        for name, arguments in RUNS.items():
            root.must(f"rm -rf /out; {command} run {arguments.format(scans='/scans')} -o /out --no-cache --picture -q")
            self.assertEqual(hashes(root.path / "out"), Expected.results[name], name)
            print_figure(f"{root.path.name}: {name}: {len(Expected.results[name])} files have the bytes of the source build")

    def check_commands(self, command: str) -> None:
        self.assertEqual(self.root.must(f"{command} --version").strip(), f"scanmill {version()}")
        self.assertIn("nightly: ok", self.root.must(f"{command} check nightly").replace(".yaml", ""))
        self.assertEqual(self.root.run(f"{command} --sideways").returncode, 2)
        self.assertEqual(len(self.root.must(f"{command} list --names").split()), len(list((BUILD / "lib/scanmill/plugins").glob("*.so"))))
        self.root.must(f"cd /tmp; {command} run compare-shapes -o shapes -q --no-cache; {command} report shapes --html page.html")
        self.assertGreater((self.root.path / "tmp/page.html").stat().st_size, 500_000)

    def check_formats(self, command: str) -> None:
        """The modules of formats write what the command reads. A run before has left a mesh in /out."""
        for scan, target in (("/scans/ball.ply", "pcd"), ("/scans/ball.ply", "vtp"), ("/out/raw-scans.ply", "glb"), ("/out/raw-scans.ply", "3mf")):
            self.root.must(f"{command} convert {scan} /converted.{target}")
            self.assertGreater((self.root.path / f"converted.{target}").stat().st_size, 1000, target)


class WheelTests:
    """What holds for the wheel in every system."""

    suite: str

    @classmethod
    def setUpClass(cls) -> None:
        Expected.make()
        cls.root = Root(cls.suite, cls.suite, "python3,python3-venv")
        cls.wheel = the_only("scanmill-*.whl")
        cls.root.put(cls.wheel, "/")
        for scan in Expected.scans.iterdir():
            cls.root.put(scan, "/scans")
        assert cls.root.run("command -v gcc g++ cc ld").stdout == ""
        begin = time.monotonic()
        cls.root.must(f"python3 -m venv /venv && /venv/bin/{INSTALL} /{cls.wheel.name}")
        cls.seconds = time.monotonic() - begin
        cls.command = "/venv/bin/scanmill"

    def test_installs_in_a_minute(self) -> None:
        size = self.root.must("du -sm /venv/lib/*/site-packages/scanmill* | awk '{ sum += $1 } END { print sum }'").strip()
        print_figure(f"{self.suite}: {self.wheel.name}, {self.wheel.stat().st_size / 1e6:.1f} MB, installed in "
                     f"{self.seconds:.1f} s with the environment, {size} MB on disk")
        self.assertLess(self.seconds, 60)

    def test_results_are_those_of_the_source_build(self) -> None:
        self.check_results(self.command)
        self.check_formats(self.command)

    def test_commands(self) -> None:
        self.check_commands(self.command)
        self.check_commands("/venv/bin/python3 -m scanmill")
        self.assertEqual(self.root.must("/venv/bin/python3 -c 'import scanmill; print(scanmill.__version__)'").strip(), version())

    def test_functions_of_python(self) -> None:
        """The tests of the Python package, with this system's Python and the packages that the functions need."""
        error = self.root.run("/venv/bin/python3 -c 'import scanmill; scanmill.read'").stderr
        self.assertRegex(error, "the functions of scanmill need two more packages: pip install numpy nanobind-backend")
        number = self.root.must("python3 -c 'import sys; print(sys.version_info.minor)'").strip()
        wheels = SOURCE / f"build/packages/python-3.{number}"
        if not wheels.exists():
            download = f"pip download --quiet --only-binary=:all: --python-version 3.{number} --dest '{wheels}.part'"
            shell(f"python3 -m {download} numpy nanobind-backend && mv '{wheels}.part' '{wheels}'")
        for file in wheels.iterdir():
            self.root.put(file, "/wheels")
        for file in (SOURCE / "tests/python").glob("*.py"):
            self.root.put(file, "/source/tests/python")
        self.root.put(SOURCE / "docs/how-to/use-from-python.md", "/source/docs/how-to")
        self.root.put(DATA / "points_3/kitten.xyz", "/source/build/data/points_3")
        self.root.must(f"python3 -m venv /functions && /functions/bin/{INSTALL} --find-links /wheels '/{self.wheel.name}[python]'")
        done = self.root.run("cd /source/tests/python && /functions/bin/python3 -B -m unittest discover -p '*_test.py'")
        self.assertEqual(done.returncode, 0, done.stderr)
        print_figure(f"{self.suite}: tests of the Python package: {done.stderr.strip().splitlines()[-1]}, {done.stderr.strip().splitlines()[-3]}")

    def test_list_starts_fast(self) -> None:
        for _ in range(ROUNDS):
            listing = self.root.milliseconds(f"{self.command} list")
            python = self.root.milliseconds("/venv/bin/python3 -c pass")
            if listing[10] - python[10] < 50:
                break
        print_figure(f"{self.suite}: list takes {listing[10]:.0f} ms, of which Python's start takes {python[10]:.0f} ms (medians)")
        self.assertLess(listing[10] - python[10], 50)

    def test_no_library_is_missing(self) -> None:
        files = "/venv/lib/*/site-packages/scanmill* -type f \\( -name '*.so*' -o -path '*/bin/*' \\)"
        lines = self.root.must(f"find {files} -exec ldd {{}} + 2>/dev/null")
        self.assertNotIn("not found", lines)
        own = {line.split(" => ")[1].split()[0] for line in lines.splitlines() if " => /" in line and "/venv/" not in line}
        print_figure(f"{self.suite}: libraries of the system: {', '.join(sorted(pathlib.Path(path).name for path in own))}")

    def test_a_relative_path_and_a_path_with_spaces_work(self) -> None:
        self.assertIn("scanmill", self.root.must("cd /venv/bin && ./scanmill --version"))
        self.root.must(f"python3 -m venv '/a b/v c' && '/a b/v c/bin/python3' -m {INSTALL} /{self.wheel.name}")
        self.check_results("'/a b/v c/bin/scanmill'")
        self.root.must("rm -rf '/a b'")

    def test_signals_end_the_program(self) -> None:
        done = self.root.run(f"cd /tmp; timeout --preserve-status --signal=INT 2 {self.command} batch nightly -o killed --no-cache -q")
        self.assertEqual(done.returncode, 130, done.stderr)

    def test_without_write_permission_or_home(self) -> None:
        """Another user, whose folder this is not, without HOME."""
        self.root.must("mount --bind /venv /venv && mount -o remount,ro,bind /venv; mkdir -p /free; chmod 1777 /free")
        try:
            check_without_home(self, self.command)
        finally:
            shell(f"umount --lazy '{self.root.path}/venv'")

    def test_two_versions_and_an_uninstalled_one(self) -> None:
        other = other_version(self.wheel)
        self.root.put(other, "/")
        self.root.must(f"python3 -m venv /other && /other/bin/{INSTALL} /{other.name}")
        self.assertEqual(self.root.must("/other/bin/scanmill --version").strip(), f"scanmill {OTHER}")
        self.assertEqual(self.root.must(f"{self.command} --version").strip(), f"scanmill {version()}")
        self.check_results("/other/bin/scanmill")
        self.check_results(self.command)
        # A module of the other version is refused with both versions, and what does not use it runs.
        plugins = "/other/lib/*/site-packages/scanmill/tree/lib/scanmill/plugins"
        self.root.must(f"mkdir /plugins; for end in so json; do cp {plugins}/scanmill-crop.$end /plugins/scanmill-trim.$end; done; "
                       "sed -i 's/\"name\": *\"crop\"/\"name\":\"trim\"/' /plugins/scanmill-trim.json")
        done = self.root.run(f"export SCANMILL_PLUGIN_PATH=/plugins; {self.command} list; {self.command} check nightly")
        self.assertEqual(done.returncode, 0, done.stderr)
        refusal = f"was built for another program: it needs 'scanmill {OTHER}.*this is 'scanmill {version()}"
        self.assertRegex(done.stdout + done.stderr, refusal)
        self.root.must("/other/bin/pip uninstall --yes --quiet scanmill")
        self.assertEqual(self.root.must("find /other -ipath '*scanmill*'"), "")
        self.assertIn("No module named scanmill", self.root.run("/other/bin/python3 -m scanmill").stderr)
        self.check_results(self.command)

    def test_a_damaged_install_says_so(self) -> None:
        binary = self.root.must("ls /venv/lib/*/site-packages/scanmill/tree/bin/scanmill").strip()
        self.root.must(f"mv {binary} {binary}.away")
        done = self.root.run(f"{self.command} list")
        self.root.must(f"mv {binary}.away {binary}")
        self.assertEqual(done.returncode, 3)
        self.assertRegex(done.stderr, r"error: '.*/bin/scanmill' cannot be started: No such file or directory\nhint: install")
        self.root.must("mount --bind /venv /venv && mount -o remount,noexec,bind /venv")
        done = self.root.run("/usr/bin/env PYTHONPATH=$(echo /venv/lib/*/site-packages) python3 -m scanmill list")
        shell(f"umount --lazy '{self.root.path}/venv'")
        self.assertEqual(done.returncode, 3)
        self.assertRegex(done.stderr, r"cannot be started: Permission denied\nhint: .*noexec")

    def test_a_full_disk_is_refused(self) -> None:
        self.root.must("mkdir -p /small && mount -t tmpfs -o size=60m tmpfs /small && python3 -m venv /small/venv")
        done = self.root.run(f"/small/venv/bin/{INSTALL} /{self.wheel.name}")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("No space left on device", done.stderr)
        print_figure(f"{self.suite}: full disk: {done.stderr.strip().splitlines()[-1]}")
        # pip leaves a part of the tree, but no command; a new environment replaces it.
        self.assertEqual(self.root.run("/small/venv/bin/scanmill list").returncode, 127)
        self.root.must("mount -o remount,size=900m /small && python3 -m venv --clear /small/venv")
        self.root.must(f"/small/venv/bin/{INSTALL} /{self.wheel.name}")
        self.check_results("/small/venv/bin/scanmill")
        self.root.must("umount /small")


OTHER = "0.1.0"[:-1] + "9"


def other_version(wheel: pathlib.Path) -> pathlib.Path:
    """A wheel of another version: the same with its version replaced, which must have as many characters."""
    assert len(OTHER) == len(version()) and OTHER != version()
    target = SOURCE / "build/packages" / wheel.name.replace(version(), OTHER)
    with tempfile.TemporaryDirectory() as temporary:
        work = pathlib.Path(temporary)
        unpack(wheel, work)
        for file in sorted(work.rglob("*"), reverse=True):
            if file.is_file():
                mode, content = file.stat().st_mode, file.read_bytes()
                for before in (b"scanmill ", b"libscanmill-core.so.", b"libscanmill-engine.so.", b"Version: "):
                    content = content.replace(before + version().encode(), before + OTHER.encode())
                file.write_bytes(content)
                file.chmod(mode)
            if version() in file.name and "scanmill" in file.name:
                file.rename(file.with_name(file.name.replace(version(), OTHER)))
        pack(work, target)
    return target


class WheelOnDebian12(WheelTests, Package):
    suite = "bookworm"


class WheelOnDebian13(WheelTests, Package):
    suite = "trixie"


class WheelOnDebian11(unittest.TestCase):
    def test_an_older_c_library_is_refused(self) -> None:
        try:
            root = Root("bullseye", "bullseye", "python3,python3-venv")
        except subprocess.CalledProcessError:
            self.skipTest("needs Debian 11, which this machine's archive does not have")
        try:
            wheel = the_only("scanmill-*.whl")
            root.put(wheel, "/")
            done = root.run(f"python3 -m venv /venv && /venv/bin/{INSTALL.replace(' --root-user-action=ignore', '')} /{wheel.name}")
            self.assertEqual(done.returncode, 1)
            self.assertIn("is not a supported wheel on this platform", done.stderr)
            print_figure(f"older C library: {done.stderr.strip().splitlines()[0]}")
        finally:
            root.close()


class DebOnDebian12(Package):
    @classmethod
    def setUpClass(cls) -> None:
        Expected.make()
        cls.root = Root("bookworm-minimal", "bookworm")
        cls.package = the_only("scanmill_*.deb")
        cls.root.put(cls.package, "/")
        for scan in Expected.scans.iterdir():
            cls.root.put(scan, "/scans")
        cls.root.must("apt-get update -qq")
        before = cls.root.must("dpkg-query -W -f '${Package}\n'").split()
        begin = time.monotonic()
        cls.root.must(f"DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends /{cls.package.name}")
        cls.seconds = time.monotonic() - begin
        cls.added = len(set(cls.root.must("dpkg-query -W -f '${Package}\n'").split()) - set(before))
        cls.command = "scanmill"

    def test_installs_in_a_minute(self) -> None:
        size = self.root.must("dpkg-query -W -f '${Installed-Size}' scanmill")
        print_figure(f"{self.package.name}: {self.package.stat().st_size / 1e6:.1f} MB, installed with {self.added - 1} "
                     f"packages in {self.seconds:.1f} s, {int(size) / 1024:.0f} MiB on disk")
        self.assertLess(self.seconds, 60)

    def test_results_are_those_of_the_source_build(self) -> None:
        self.check_results(self.command)
        self.check_formats(self.command)

    def test_commands(self) -> None:
        self.check_commands(self.command)

    def test_list_starts_fast(self) -> None:
        for _ in range(ROUNDS):
            listing = self.root.milliseconds("scanmill list")
            if listing[10] < 50:
                break
        print_figure(f".deb: list takes {listing[10]:.0f} ms (median)")
        self.assertLess(listing[10], 50)

    def test_runs_where_it_is_unpacked(self) -> None:
        """A second version beside the installed one."""
        self.root.must(f"dpkg-deb -x /{self.package.name} '/else where'")
        self.check_results("'/else where/usr/bin/scanmill'")
        loaded = self.root.must("ldd '/else where/usr/bin/scanmill' | grep libscanmill")
        self.assertEqual(loaded.count("=> /else where/"), 2, loaded)

    def test_manual_and_completions_are_in_their_places(self) -> None:
        files = self.root.must("dpkg -L scanmill").split()
        for file in ("man/man1/scanmill.1.gz", "bash-completion/completions/scanmill", "zsh/vendor-completions/_scanmill",
                     "fish/vendor_completions.d/scanmill.fish", "doc/scanmill/copyright", "doc/scanmill/changelog.gz"):
            self.assertIn(f"/usr/share/{file}", files)
        words = self.root.must("source /usr/share/bash-completion/completions/scanmill; COMP_WORDS=(scanmill che) COMP_CWORD=1 "
                               "; _scanmill; echo \"${COMPREPLY[@]}\"")
        self.assertEqual(words.strip(), "check")

    def test_depends_on_what_it_loads(self) -> None:
        lines = self.root.must("ldd /usr/bin/scanmill /usr/lib/libscanmill-*.so.* /usr/lib/scanmill/*/*.so")
        self.assertNotIn("not found", lines)

    def test_without_write_permission_or_home(self) -> None:
        self.root.must("mount --bind /usr /usr && mount -o remount,ro,bind /usr; mkdir -p /free; chmod 1777 /free")
        try:
            check_without_home(self, self.command)
        finally:
            shell(f"umount --lazy '{self.root.path}/usr'")

    def test_zz_uninstalls_without_a_trace_and_needs_space(self) -> None:
        self.root.must("cp -r /usr/lib/scanmill/plugins /plugins; apt-get purge -y -qq scanmill")
        self.assertEqual(self.root.must("find /usr /etc /var/lib/dpkg -name '*scanmill*'"), "")
        self.assertEqual(self.root.run("scanmill list").returncode, 127)
        self.root.must("mkdir -p /usr/lib/scanmill && mount -t tmpfs -o size=2m tmpfs /usr/lib/scanmill")
        done = self.root.run(f"dpkg -i /{self.package.name}")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("No space left on device", done.stderr)
        print_figure(".deb: full disk: " + " ".join(line.strip() for line in done.stderr.splitlines() if "No space" in line))
        self.assertEqual(self.root.run("scanmill list").returncode, 127)
        self.root.must(f"umount /usr/lib/scanmill; dpkg -i /{self.package.name}")
        self.check_results(self.command)


class FiltersOfOthers(unittest.TestCase):
    """The plugin guide, followed against the installed packages."""

    @classmethod
    def setUpClass(cls) -> None:
        cls.root = Root("bookworm-compiler", "bookworm",
                        "python3,python3-venv,g++,cmake,make,libeigen3-dev,libfmt-dev,libgmp-dev,nlohmann-json3-dev")

    @classmethod
    def tearDownClass(cls) -> None:
        cls.root.close()

    def follow(self, prefix: str, path: str, folder: str) -> None:
        guide = Guide(SOURCE / "docs/plugin-guide/README.md")
        guide.follow(self.root, folder, {"CMAKE_PREFIX_PATH": prefix, "PATH": f"{path}:/usr/bin:/bin", "HOME": folder})
        print_figure(f"plugin guide: {len(guide.commands)} commands print what the page shows, against {prefix}")

    def test_against_the_wheel_and_the_deb(self) -> None:
        wheel, package = the_only("scanmill-*.whl"), the_only("scanmill_*.deb")
        self.root.put(wheel, "/")
        self.root.put(package, "/")
        self.root.must(f"python3 -m venv '/a venv' && '/a venv/bin/python3' -m {INSTALL} /{wheel.name}")
        prefix = self.root.must("'/a venv/bin/python3' -c 'import scanmill; print(scanmill.prefix)'").strip()
        self.follow(prefix, "/a venv/bin", "/wheel-guide")
        # A module that another package's headers compiled passes, as the versions are equal; after `install` it is beside the others.
        self.root.must("cmake --install /wheel-guide/build")
        self.assertIn("crop-sphere", self.root.must("'/a venv/bin/scanmill' list --names"))
        self.root.must(f"apt-get update -qq && apt-get install -y -qq --no-install-recommends /{package.name}")
        self.follow("/usr", "/usr/bin", "/deb-guide")
        self.assertIn("crop-sphere", self.root.must("SCANMILL_PLUGIN_PATH=/wheel-guide/build/plugins scanmill list --names"))


class Processors(unittest.TestCase):
    def test_without_avx_the_bytes_are_the_same(self) -> None:
        emulator = shutil.which("qemu-x86_64-static") or shutil.which("qemu-x86_64")
        if not emulator:
            self.skipTest("needs qemu-user")
        Expected.make()
        with tempfile.TemporaryDirectory() as temporary:
            work = pathlib.Path(temporary)
            unpack(the_only("scanmill-*.whl"), work / "wheel")
            program = work / "wheel/scanmill/tree/bin/scanmill"
            arguments = RUNS["quickstart"].format(scans=Expected.scans).split()
            subprocess.run([emulator, "-cpu", "Nehalem", program, "run", *arguments, "-o", work / "out", "--no-cache", "-j", "0", "-q"],
                           check=True, capture_output=True)
            expected = {name: value for name, value in Expected.results["quickstart"].items() if name.endswith(".stl")}
            self.assertEqual(hashes(work / "out"), expected)
            print_figure("quickstart has the bytes of the source build on a processor without AVX (qemu, Nehalem)")


class Image(unittest.TestCase):
    """The image as another user, without network; in podman where it runs, else in chroot."""

    def test_runs_as_another_user(self) -> None:
        Expected.make()
        image = the_only("scanmill-*-image.tar.gz")
        with tempfile.TemporaryDirectory(dir=SOURCE / "build/packages") as temporary:
            work = pathlib.Path(temporary)
            (work / "work").mkdir()
            for scan in Expected.scans.iterdir():
                shutil.copy(scan, work / "work")
            shell(f"chown -R 1234:1234 '{work}/work'; chmod 755 '{work}'")
            how = self.run_in_podman(image, work) or self.run_in_chroot(image, work)
            expected = {name: value for name, value in Expected.results["quickstart"].items() if name.endswith(".stl")}
            self.assertEqual(hashes(work / "work/out"), expected)
            self.assertEqual((work / "work/out/kitten.stl").stat().st_uid, 1234)
            print_figure(f"{image.name}, {image.stat().st_size / 1e6:.0f} MB: quickstart in {how} has the bytes of the source build")

    def run_in_podman(self, image: pathlib.Path, work: pathlib.Path) -> str:
        if not shutil.which("podman"):
            return ""
        podman = f"podman --root '{work}/pd' --runroot '{work}/run' --cgroup-manager cgroupfs --events-backend file"
        # Some kernels refuse mixed control groups and high limits.
        script = f"""
            umount /sys/fs/cgroup/unified 2>/dev/null || true
            {podman} import --change 'ENTRYPOINT ["scanmill"]' --change 'WORKDIR /work' '{image}' local/scanmill >/dev/null
            {podman} run --rm --ulimit nofile=1024:1024 --ulimit nproc=1024:1024 --network=none --user 1234:1234 -e HOME=/tmp \
                -v '{work}/work:/work' local/scanmill run quickstart kitten.xyz ball.ply -o out -q
            """
        done = subprocess.run(["unshare", "--mount", "--propagation", "private", "bash", "-euc", script],
                              capture_output=True, text=True, check=False)
        if done.returncode != 0:
            print_figure(f"podman does not run here: {done.stderr.strip().splitlines()[-1:]}")
            return ""
        return "podman"

    def run_in_chroot(self, image: pathlib.Path, work: pathlib.Path) -> str:
        root = work / "root"
        root.mkdir()
        shell(f"tar -xf '{image}' -C '{root}' --exclude='./dev/*'; mount --rbind /dev '{root}/dev'; mount -t proc proc '{root}/proc'; "
              f"mount --bind '{work}/work' '{root}/work'; chroot --userspec=1234:1234 '{root}' env -i HOME=/tmp PATH=/usr/bin:/bin "
              f"bash -c 'cd /work && scanmill run quickstart kitten.xyz ball.ply -o out -q'; umount -l '{root}/work' '{root}/proc' '{root}/dev'")
        return "chroot"


if __name__ == "__main__":
    unittest.main()
