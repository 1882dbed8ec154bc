#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# page_pictures.sh PROGRAM: takes the pictures of pages for the documentation: it runs the commands of two pages, writes their report
# and sheet, and opens them in headless Chromium. Skipped, with a sentence, without Chromium or if the program has no report page.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
program=$(realpath "$1")
chromium=${CHROMIUM:-$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)}
if [ -z "$chromium" ]; then
    echo "skipped: pictures of pages need Chromium; set CHROMIUM to its path"
    exit 0
fi
if [ ! -e "$(dirname "$program")/../share/scanmill/report/page.html" ]; then
    echo "skipped: this program was built without the report page"
    exit 0
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/bin"
ln -s "$program" "$folder/bin/scanmill"
export PATH="$folder/bin:$PATH" HOME="$folder"

# begin PAGE: makes a folder with the files of the page, in which its commands run.
begin() {
    mkdir -p "$folder/$(basename "$1" .md)"
    cd "$folder/$(basename "$1" .md)"
    awk '/^<!-- file: /{name=$3} /^```/{if (open) {open=0; name=""} else if (name) {open=1; folder=name; if (sub("/[^/]*$", "", folder)) system("mkdir -p " folder); next}} open{print > name}' "$root/$1"
}
# commands PAGE: the commands of its console blocks.
commands() { awk '/^<!-- run -->/{run=1} /^```/{if (open) {open=0; run=0} else if (run) {open=1; next}} open && sub("^[$] ", "")' "$root/$1"; }

# shoot FILE[#HASH] WIDTH HEIGHT PICTURE
shoot() {
    "$chromium" --headless --no-sandbox --disable-gpu --hide-scrollbars --virtual-time-budget=4000 --window-size="$2,$3" \
        --screenshot="$folder/shot.png" "file://$PWD/$1" >/dev/null 2>&1
    mkdir -p "$(dirname "$root/$4")"
    mv "$folder/shot.png" "$root/$4"
}

# The tutorial: a doubtful mesh of its second night, then the night whose meshes regressed, without the commands that undo the change.
page=docs/tutorial/4-nightly-batch.md
begin $page
commands $page | sed '/s.default: 1 mm/,$d' >first.sh
commands $page | sed -n '/s.default: 1 mm/,$p' | sed '/s.default: 2 mm/,$d' >second.sh
bash first.sh >/dev/null 2>&1 || true
scanmill report nights --html second.html >/dev/null
shoot 'second.html#cell-3' 1120 820 docs/how-to/pictures/night-cell.png
bash second.sh >/dev/null 2>&1 || true
scanmill report nights --html night.html >/dev/null || [ $? = 4 ]
shoot night.html 1120 820 docs/how-to/pictures/night-page.png

# The part of the page on inspection that fails.
page=docs/how-to/inspect-a-part.md
begin $page
commands $page >commands.sh
bash commands.sh >/dev/null 2>&1 || true
scanmill report out --sheet . --html sheet.html >/dev/null || [ $? = 1 ]
shoot sheet.html 850 1230 docs/how-to/inspect-a-part/sheet.png
