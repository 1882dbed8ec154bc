# SPDX-License-Identifier: GPL-3.0-or-later
"""A program that answers as its requests tell it to, and misbehaves in every way that a peer can."""
import json
import os
import signal
import sys
import time

held = None
for line in sys.stdin:
    request = json.loads(line)
    job = request["do"]
    if job == "answer":
        print(json.dumps(request["with"]))
    elif job == "versions":
        print('{"fake": "1"}')
    elif job == "hold":
        held = bytearray(request["mebibytes"] << 20)
        held[::4096] = b"x" * len(held[::4096])
        print(json.dumps({"seconds": 1.0}))
    elif job == "release":
        held = None
        print("{}")
    elif job == "count":  # seconds 1, 2, 3 …: which round it is
        held = (held or 0) + 1
        print(json.dumps({"seconds": float(held), "round": held}))
    elif job == "answer-once":  # and fail ever after
        print(json.dumps({"failed": "tired"} if held else request["with"]))
        held = True
    elif job == "log":  # who was asked when, over all processes
        with open(request["file"], "a") as file:
            file.write(request["name"] + "\n")
        print(json.dumps({"seconds": 1.0, "threads": request.get("threads", 0)}))
    elif job == "crash":
        print("the last words", file=sys.stderr, flush=True)
        os.kill(os.getpid(), signal.SIGSEGV)
    elif job == "exit":
        sys.exit("it is over")
    elif job == "hang":
        time.sleep(60)
    elif job == "mumble":
        print("no JSON at all")
    sys.stdout.flush()
