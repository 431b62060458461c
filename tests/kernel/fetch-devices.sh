#!/bin/sh
# Fetches what libinput's own tests know of real tablets and touchpads, and puts it where the kernel tests look for it: names, numbers,
# axes, ranges and buttons of devices. A second.
#
# Source: Debian's source package of libinput in its newest release (licence: MIT). The tests read facts from it; nothing of it is part
# of this project.
#
# Needs: apt-get install debian-archive-keyring tar
set -eu

here=$(cd "$(dirname "$0")" && pwd)
. "$here/own-lists.sh"
cache=${XDG_CACHE_HOME:-$HOME/.cache}/tactpad
# Pressure pads are among them since then.
oldest=1.30

for program in apt-get apt-cache dpkg tar; do
    command -v "$program" >/dev/null || {
        echo "$program is missing: this script is for Debian and what comes of it" >&2
        exit 1
    }
done
work=$(mktemp -d "${TMPDIR:-/tmp}/fetch-devices.XXXXXX")
trap 'rm -rf "$work"' EXIT
cd "$work"
own_lists "$work" "deb-src stable" "deb-src unstable"
version=$(apt-cache $own showsrc libinput | sed -n 's/^Version: //p' | sort -V | tail -n 1)
dpkg --compare-versions "${version:-0}" ge "$oldest" || {
    echo "libinput ${version:-} is too old: $oldest is needed" >&2
    exit 1
}
echo "downloading the source of libinput $version"
apt-get $own source -qq --download-only "libinput=$version"

target=$cache/libinput-${version%-*}
mkdir unfinished
tar -xzf libinput_*.orig.tar.gz -C unfinished --strip-components=1 --wildcards '*/test/litest-device-*.c' '*/quirks/*.quirks'
rm -rf "$target"
mkdir -p "$cache"
mv unfinished "$target"
echo "$target"
