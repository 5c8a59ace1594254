#!/usr/bin/env python3
"""clang-tidy over the tree, within a time. A file that was clean is remembered by the hash of all that it is made of
(itself, the headers that the build says it includes, the checks), so that a second run looks only at what changed.
Files with changes come first. What the time did not reach is counted, not hidden."""

import argparse
import concurrent.futures
import hashlib
import json
import pathlib
import re
import subprocess
import sys
import time

FOLDERS = ("framework", "passes", "tests")


def dependencies(build):
    """The headers of this tree that each object file was made of, by source."""
    text = subprocess.run(["ninja", "-C", build, "-t", "deps"], capture_output=True, text=True, check=False).stdout
    result = {}
    for block in text.split("\n\n"):
        lines = [line.strip() for line in block.splitlines()[1:] if line.strip()]
        paths = [str((pathlib.Path(build) / line).resolve()) for line in lines]
        if paths:
            result[paths[0]] = paths
    return result


def sources(build, root):
    commands = json.loads((pathlib.Path(build) / "compile_commands.json").read_text())
    files = {str((pathlib.Path(c["directory"]) / c["file"]).resolve()) for c in commands}
    return sorted(f for f in files if pathlib.Path(f).is_relative_to(root)
                  and pathlib.Path(f).relative_to(root).parts[0] in FOLDERS)


def changed(root):
    """Files of the last commit and of the working tree."""
    names = set()
    for command in (["git", "diff", "--name-only", "HEAD~1"], ["git", "ls-files", "-o", "--exclude-standard"]):
        done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)
        names.update(str((root / line).resolve()) for line in done.stdout.splitlines())
    return names


def digest(file, parts, root, checks):
    key = hashlib.sha256(checks)
    for part in sorted(set(parts) | {file}):
        path = pathlib.Path(part)
        if path.is_relative_to(root) and path.is_file():
            key.update(part.encode())
            key.update(path.read_bytes())
    return key.hexdigest()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", default="build")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=300)
    parser.add_argument("--filter", default="", help="only files whose path in the tree matches")
    arguments = parser.parse_args()
    root = pathlib.Path(__file__).resolve().parents[2]
    build = str(pathlib.Path(arguments.build).resolve())
    memory = pathlib.Path(build) / "tidy"
    memory.mkdir(exist_ok=True)
    checks = (root / ".clang-tidy").read_bytes()

    # Clang does not know this flag of GCC, which passes are built with.
    commands = (pathlib.Path(build) / "compile_commands.json").read_text().replace(" -fno-gnu-unique", "")
    (memory / "compile_commands.json").write_text(commands)

    included = dependencies(build)
    first = changed(root)
    files = [f for f in sources(build, root) if re.search(arguments.filter, str(pathlib.Path(f).relative_to(root)))]
    keys = {f: digest(f, included.get(f, []), root, checks) for f in files}
    files.sort(key=lambda f: (f not in first, not first.intersection(included.get(f, [])), f))
    todo = [f for f in files if not (memory / keys[f]).exists()]

    deadline = time.monotonic() + arguments.seconds
    bad, skipped = [], 0

    def check(file):
        if time.monotonic() > deadline:
            return None
        done = subprocess.run(["clang-tidy", "-p", str(memory), "--quiet", file], capture_output=True, text=True, check=False)
        if done.returncode == 0:
            (memory / keys[file]).touch()
        return done

    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for file, done in zip(todo, pool.map(check, todo)):
            if done is None:
                skipped += 1
            elif done.returncode != 0:
                bad.append(file)
                print(done.stdout, flush=True)
            else:
                print(pathlib.Path(file).relative_to(root), flush=True)
    print(f"clang-tidy: {len(files) - len(bad) - skipped} of {len(files)} files clean, {len(bad)} with findings, "
          f"{skipped} not reached in {arguments.seconds:.0f} s")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
