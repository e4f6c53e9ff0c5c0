#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Writes the manual's pages of all commands from the program's own help: en/commands.md, and ja/commands.md by the translations beside this script (English, a tab, Japanese).
#   packaging/commands.sh [PROGRAM [FOLDER]]     build/app/imomushi and assets/manual unless given
# Texts without a translation stay English; they are printed, and the status is 1.
set -euo pipefail
here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd -P)
program="${1:-$here/../build/app/imomushi}"
folder="${2:-$here/../assets/manual}"
mkdir -p "$folder/en" "$folder/ja"

page() {
    LC_ALL=C awk -F'\t' -v language="$1" '
        # Translations first.
        FNR == NR { if (NF == 2) japanese[$1] = $2; next }
        function said(text) {
            if (language == "en") return text
            if (text in japanese) return japanese[text]
            print text > "/dev/stderr"
            failed = 1
            return text
        }
        # What Markdown would take for its own.
        function plain(text) { gsub(/[*_<|]/, "\\\\&", text); return text }
        # A long help lists properties by what has them: an item each.
        function paragraphs(text, long) {
            long = length(text) > 400
            while (long && match(text, /\. [A-Za-z-]+: [a-z-]+ \(/)) {
                print item plain(said(substr(text, 1, RSTART))) (item == "" ? "\n" : "")
                text = substr(text, RSTART + 2)
                item = "* "
            }
            print item plain(said(text))
            item = ""
        }
        function start() {
            print said("# All commands") "\n"
            print said("This page is made from `imomushi run --help`. What scripts are, how they are run and what they answer: [Scripts](scripts.md).") "\n"
            print said("A key in [brackets] can be left out.")
        }
        BEGIN { FS = "\t" }
        FNR == 1 { start() }
        /^[a-z]+(-[a-z]+)*$/ { name = $0; keys = 0; print "\n## " name "\n"; next }
        name == "" { next }
        /^    / {
            text = substr($0, 5)
            if (!keys && !helped[name]++) { paragraphs(text); next }
            if (!keys++) print "\n| " said("key") " | " said("type") " | " said("what it is") " |\n|---|---|---|"
            key = text
            sub(/ .*/, "", key)
            rest = substr(text, length(key) + 1)
            sub(/^ +/, "", rest)
            dot = index(rest, ". ")
            bare = key
            gsub(/[][]/, "", bare)
            print "| " (bare == key ? "`" key "`" : "[`" bare "`]") " | " plain(said(substr(rest, 1, dot - 1))) " | " plain(said(substr(rest, dot + 2))) " |"
        }
        END { exit failed }
    ' "$here/commands_ja.tsv" <("$program" run --help) >"$folder/$1/commands.md"
}

page en
page ja
