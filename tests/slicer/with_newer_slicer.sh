#!/usr/bin/env bash
# Runs tests with the PrusaSlicer that AERATE_PRUSA_SLICER names in the place of the installed one:
#   with_newer_slicer.sh PROGRAM...     test programs, one after the other
# Exits with 77, which CTest takes for "skipped", where it names none. AERATE_PRUSA_TESTS is a filter of theirs.
set -euo pipefail

program=${AERATE_PRUSA_SLICER:-}
if [ -z "$program" ]; then
  echo 'AERATE_PRUSA_SLICER names no program: nothing was sliced'
  exit 77
fi
[ -x "$program" ] || { echo "$program: is no program" >&2; exit 1; }

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# What stands on the path is called. From 2.9 on it asks whether scripts are to be run, and leaves 3MF where its coordinates
# are: tests that slice one themselves mean the middle of the bed.
cat > "$folder/prusa-slicer" <<END
#!/bin/sh
case "\$*" in
  *--dont-arrange*) ;;
  *.3mf | *.3MF) set -- --center 100,100 "\$@" ;;
esac
echo y | exec '$program' "\$@"
END
chmod +x "$folder/prusa-slicer"

export PATH=$folder:$PATH GTEST_FILTER=${AERATE_PRUSA_TESTS:-*}
"$folder/prusa-slicer" --help | sed -n 1p
failed=0
for test in "$@"; do "$test" || failed=1; done
exit "$failed"
