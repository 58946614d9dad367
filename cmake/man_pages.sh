#!/usr/bin/env bash
# Man pages of fjr and of each subcommand, from what they say with --help:  cmake/man_pages.sh PROGRAM FOLDER
# Needs help2man.
set -euo pipefail
program=$1 folder=$2
version=$("$program" --version)

# page WORD...: of fjr WORD...
page() {
  local help name about command
  help=$("$program" "$@" --help)
  name=$(IFS=-; echo "fjr${*:+-$*}")
  about=$(sed -n '1{s/^fjr: //;p}' <<<"$help")
  help2man --no-info --section 1 --version-string "$version" --name "$about" "$program${*:+ $*}" |
    sed -e "s/^\.TH .* \"1\"/.TH ${name^^} \"1\"/" -e "s/^fjr[a-z0-9 \\\\-]* \\\\- /$name \\\\- /" | gzip -9n > "$folder/$name.1.gz"
  for command in $(awk '/^Subcommands:/ { on = 1; next } /^$/ { on = 0 } on && /^  [a-z]/ { print $1 }' <<<"$help"); do
    page "$@" "$command"
  done
}

mkdir -p "$folder"
page
