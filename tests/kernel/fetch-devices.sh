#!/bin/sh
# Fetches what libinput's own tests know of real tablets and touchpads, and puts it where the kernel tests look for it: names, numbers,
# axes, ranges and buttons of devices. A second.
#
# Source: Debian's source package of libinput in its newest release (licence: MIT). The tests read facts from it; nothing of it is part
# of this project.
#
# Needs: apt-get install debian-archive-keyring tar
set -eu

cache=${XDG_CACHE_HOME:-$HOME/.cache}/tactpad
keyring=/usr/share/keyrings/debian-archive-keyring.gpg
# Pressure pads are among them since then.
oldest=1.30

for program in apt-get apt-cache dpkg tar; do
    command -v "$program" >/dev/null || {
        echo "$program is missing: this script is for Debian and what comes of it" >&2
        exit 1
    }
done
[ -f "$keyring" ] || {
    echo "$keyring is missing: apt-get install debian-archive-keyring" >&2
    exit 1
}

# The mirror that this machine uses anyway.
mirror=$(apt-get indextargets --format '$(REPO_URI) $(ORIGIN)' 'Created-By: Packages' |
    awk '$2 == "Debian" && $1 !~ /security/ { print $1; exit }')
[ -n "$mirror" ] || {
    echo "apt knows no mirror of Debian: apt-get update" >&2
    exit 1
}

work=$(mktemp -d "${TMPDIR:-/tmp}/fetch-devices.XXXXXX")
trap 'rm -rf "$work"' EXIT
cd "$work"
mkdir -p state/lists/partial cache/archives/partial
for suite in stable unstable; do
    echo "deb-src [signed-by=$keyring] $mirror $suite main" >>sources.list
done
# Lists and state of our own: the machine's stay as they are.
ours="-o Dir::Etc::sourcelist=$work/sources.list -o Dir::Etc::sourceparts=- -o Dir::State=$work/state -o Dir::Cache=$work/cache
    -o APT::Sandbox::User="
apt-get $ours update -qq
version=$(apt-cache $ours showsrc libinput | sed -n 's/^Version: //p' | sort -V | tail -n 1)
dpkg --compare-versions "${version:-0}" ge "$oldest" || {
    echo "libinput ${version:-} is too old: $oldest is needed" >&2
    exit 1
}
echo "downloading the source of libinput $version"
apt-get $ours source -qq --download-only "libinput=$version"

target=$cache/libinput-${version%-*}
mkdir unfinished
tar -xzf libinput_*.orig.tar.gz -C unfinished --strip-components=1 --wildcards '*/test/litest-device-*.c' '*/quirks/*.quirks'
rm -rf "$target"
mkdir -p "$cache"
mv unfinished "$target"
echo "$target"
