#!/usr/bin/env bash
# The Debian package in a clean root: installed by apt with what it depends on, run, removed, and nothing is left of it.
#   test_deb.sh PROGRAM     that of the build, whose result is that of the installed one to the byte
#   AERATE_RELEASE          the folder that scripts/release made
# The root is made by mmdebstrap from where this machine's apt gets Debian. Exits with 77, which CTest takes for "skipped", where there is no
# release, or no such root can be made: it says why.
set -euo pipefail
cd "$(dirname "$0")/../.."
program=$(realpath "$1")

skip() { printf '%s\n' "NOT TESTED: the Debian package in a clean root: $1"; exit 77; }
[ -n "${AERATE_RELEASE:-}" ] || skip 'AERATE_RELEASE names no folder of scripts/release'
package=$(realpath "$AERATE_RELEASE"/aerate_*.deb)
[ -f "$package" ] || { echo "there is no package in $AERATE_RELEASE" >&2; exit 1; }

echo "-- the package itself"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
dpkg-deb --field "$package" Package Version Section Depends Maintainer
dpkg-deb --control "$package" "$folder/control"
dpkg-deb --extract "$package" "$folder/files"
(cd "$folder/files" && md5sum --quiet --check "$folder/control/md5sums")
[ "$(find "$folder/files" -type f | wc -l)" = "$(wc -l <"$folder/control/md5sums")" ]
[ -z "$(find "$folder/files" -not -user "$(id -un)" -o -perm /022 -not -type l)" ]
gzip -dc "$folder/files/usr/share/doc/aerate/changelog.gz" | cmp - CHANGELOG.md
grep -q '^Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/$' "$folder/files/usr/share/doc/aerate/copyright"
if command -v lintian >/dev/null; then
  lintian --fail-on error "$package" 2>/dev/null || { echo 'lintian has found errors' >&2; exit 1; }
else
  echo 'lintian is not installed: not asked'
fi

command -v mmdebstrap >/dev/null || skip 'mmdebstrap is not installed'
# shellcheck source=/dev/null
. /etc/os-release
apt-get indextargets --format '$(ORIGIN) deb $(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' |
  sed -n 's/^Debian deb/deb/p' | sort -u >"$folder/sources.list"
[ -s "$folder/sources.list" ] || skip 'apt has no lists of a Debian here (apt-get update gets them)'
apt-config dump | grep -iE '^Acquire::(Check-|https?::|Retries)[^ ]* "[^"]' >"$folder/apt.conf" || true
"$program" hollow samples/bunny.stl -o "$folder/expected.stl" --quiet

# Runs in the root. What is compared before and after is all but records of apt's and dpkg's.
cat >"$folder/inside" <<'END'
set -eu
export DEBIAN_FRONTEND=noninteractive
files() {
  find / -xdev \( -path /proc -o -path /sys -o -path /dev -o -path /tmp -o -path /run -o -path /var/lib/apt -o -path /var/lib/dpkg -o \
    -path /var/log -o -path /var/cache \) -prune -o -print | sort
}
# The Python module is for who has Python.
has_module=0
if dpkg-deb --contents /tmp/aerate.deb | grep /dist-packages/aerate/ >/dev/null; then
  has_module=1
  apt-get install -qq --no-install-recommends python3-numpy >/tmp/log 2>&1 || { cat /tmp/log; exit 1; }
fi
files >/tmp/before
apt-get install -qq --no-install-recommends /tmp/aerate.deb >/tmp/log 2>&1 || { cat /tmp/log; exit 1; }
dpkg --verify aerate
aerate --version
aerate hollow /tmp/bunny.stl -o /tmp/hollow.stl --picture /tmp/bunny.png --view /tmp/bunny.html --quiet
[ -s /tmp/bunny.png ]
[ -s /tmp/bunny.html ]
for page in aerate aerate-hollow aerate-batch; do gzip -t /usr/share/man/man1/$page.1.gz; done
[ -s /usr/share/bash-completion/completions/aerate ]
[ -s /usr/share/zsh/vendor-completions/_aerate ]
[ -s /usr/share/fish/vendor_completions.d/aerate.fish ]
[ -s /usr/share/applications/aerate-studio.desktop ]
[ -s /usr/share/icons/hicolor/scalable/apps/aerate.svg ]
[ $has_module = 0 ] || python3 -c 'import aerate; print("Python module", aerate.__version__)'
apt-get purge -qq --autoremove aerate >/tmp/log 2>&1 || { cat /tmp/log; exit 1; }
files >/tmp/after
diff /tmp/before /tmp/after
[ -z "$(dpkg-query -W -f '${db:Status-Status}' aerate 2>/dev/null)" ]
END

echo "-- a root of $VERSION_CODENAME with nothing but the least"
touch "$folder/made"
cat >"$folder/hook" <<END
#!/bin/sh
set -eu
rm '$folder/made'
cp '$package' "\$1/tmp/aerate.deb"
cp samples/bunny.stl "\$1/tmp/"
chroot "\$1" sh -s <'$folder/inside'
cp "\$1/tmp/hollow.stl" '$folder/hollow.stl'
END
chmod +x "$folder/hook"
if ! mmdebstrap --quiet --variant=minbase --aptopt="$folder/apt.conf" --customize-hook="$folder/hook" \
    "$VERSION_CODENAME" /dev/null "$folder/sources.list" >"$folder/log" 2>&1; then
  [ ! -e "$folder/made" ] || { tail -n 5 "$folder/log"; skip 'mmdebstrap cannot make a root here'; }
  cat "$folder/log"
  echo 'the package fails in a clean root' >&2
  exit 1
fi
cat "$folder/log"
cmp "$folder/hollow.stl" "$folder/expected.stl"
echo "installed, run and removed in $SECONDS s"
