#!/bin/sh
# The Linux kernel of the kernel tests.
#
#   tests/kernel/build-kernel.sh              builds it and puts it where they look for it: six minutes of processor time
#   tests/kernel/build-kernel.sh --path       says where they look for it
#   tests/kernel/build-kernel.sh --fits FILE  says by its exit code whether a ready kernel has all settings of uml.config
#
# It is a User-Mode Linux: a kernel that runs as an ordinary process, with the input layer in it. Source: the
# distribution's package of Linux 6.12 (licence: GPL-2.0). The kernel is built here and is no part of this project:
# nothing of it is shipped or linked.
#
# Needs (Debian 12 or newer, with its backports where 6.12 is not the release's own):
#   apt-get install bc bison busybox-static flex gcc make xz-utils
set -eu

here=$(cd "$(dirname "$0")" && pwd)
package=linux-source-6.12
settings=$(grep -E '^(CONFIG_|# CONFIG_.* is not set$)' "$here/uml.config")

# The kernel keeps the floating point registers of a process in a buffer of fixed size, 2696 longs. Newer processors
# have more registers than fit (the tile registers of AMX alone are 8 KiB), and the first process would end in a panic.
offsets=arch/x86/um/user-offsets.c
enlarge='s/DEFINE_LONGS(HOST_FP_SIZE, 2696)/DEFINE_LONGS(HOST_FP_SIZE, 12288)/'

# What makes another kernel gives it another name, so that an old one is never taken for it.
hash=$(printf '%s\n' "$package" "$settings" "$enlarge" | sha256sum | cut -c1-12)
target=${XDG_CACHE_HOME:-$HOME/.cache}/tactpad/$package-uml-$hash

# Prints those of the settings that are not among the lines of $1.
missing() {
    printf '%s\n' "$settings" | grep -vxF "$1"
}

case ${1:-} in
--path)
    echo "$target"
    exit
    ;;
--fits)
    # A kernel tells its settings without booting.
    ! missing "$("$2" --showconfig)" >/dev/null
    exit
    ;;
esac

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

sed -i "$enlarge" "$offsets"
grep -q 'HOST_FP_SIZE, 12288' "$offsets" || {
    echo "$offsets is not what this script knows: enlarge HOST_FP_SIZE there by hand" >&2
    exit 1
}

make ARCH=um tinyconfig
scripts/kconfig/merge_config.sh -m .config "$here/uml.config"
make ARCH=um olddefconfig
refused=$(missing "$(cat .config)") && {
    echo "this kernel refuses: $refused" >&2
    exit 1
}
make ARCH=um -j"$(nproc)" linux
strip linux

mkdir -p "$(dirname "$target")"
cp linux "$target.unfinished"
mv "$target.unfinished" "$target"
echo "$target"
