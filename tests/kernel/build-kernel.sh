#!/bin/sh
# Builds the Linux kernel of the kernel tests and puts it where they look for it. About ten minutes on two cores.
#
# It is a User-Mode Linux: a kernel that runs as an ordinary process, with the input layer in it. Source: the
# distribution's package of Linux 6.12 (licence: GPL-2.0). The kernel is built here and is no part of this project:
# nothing of it is shipped or linked.
#
# Needs (Debian 12 or newer, with its backports where 6.12 is not the release's own):
#   apt-get install bc bison busybox-static flex gcc make xz-utils
set -eu

here=$(cd "$(dirname "$0")" && pwd)
target=${1:-${XDG_CACHE_HOME:-$HOME/.cache}/tactpad/linux-uml-6.12}
package=linux-source-6.12

for program in apt-get bc bison dpkg-deb flex gcc make tar xz; do
    command -v "$program" >/dev/null || {
        echo "$program is missing: apt-get install bc bison flex gcc make xz-utils" >&2
        exit 1
    }
done

work=$(mktemp -d "${TMPDIR:-/tmp}/build-kernel.XXXXXX")
trap 'rm -rf "$work"' EXIT
cd "$work"

echo "downloading $package"
apt-get download "$package"
dpkg-deb -x ./"$package"_*.deb package
tar -xJf "package/usr/src/$package.tar.xz"
cd "$package"

# The kernel keeps the floating point registers of a process in a buffer of fixed size, 2696 longs. Newer processors
# have more registers than fit (the tile registers of AMX alone are 8 KiB), and the first process would end in a panic.
offsets=arch/x86/um/user-offsets.c
sed -i 's/DEFINE_LONGS(HOST_FP_SIZE, 2696)/DEFINE_LONGS(HOST_FP_SIZE, 12288)/' "$offsets"
grep -q 'HOST_FP_SIZE, 12288' "$offsets" || {
    echo "$offsets is not what this script knows: enlarge HOST_FP_SIZE there by hand" >&2
    exit 1
}

make ARCH=um tinyconfig
scripts/kconfig/merge_config.sh -m .config "$here/uml.config"
make ARCH=um olddefconfig
refused=$(grep '^CONFIG' "$here/uml.config" | grep -vxF -f .config) && {
    echo "this kernel refuses:" $refused >&2
    exit 1
}
make ARCH=um -j"$(nproc)" linux
strip linux

mkdir -p "$(dirname "$target")"
cp linux "$target.unfinished"
mv "$target.unfinished" "$target"
echo "$target"
