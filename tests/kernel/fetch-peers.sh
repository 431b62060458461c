#!/bin/sh
# Fetches other programs that make keys of keys, to measure latency beside them, and puts them where the kernel tests look for them.
# Ten minutes of processor time: two are built.
#
# Sources: kanata (LGPL-3.0) and xremap (MIT) by cargo, of fixed versions; interception-tools and caps2esc (GPL-3.0) and keyd (MIT) as
# Debian's packages, which are unpacked and not installed. They are run as programs; nothing of them is part of this project.
#
# What cannot be had is said, and written to the file left-out beside the programs. Exit code: 0 kanata and xremap are there.
#
# Needs: apt-get install debian-archive-keyring; cargo
set -eu

here=$(cd "$(dirname "$0")" && pwd)
. "$here/own-lists.sh"
target=${XDG_CACHE_HOME:-$HOME/.cache}/tactpad/peers
mkdir -p "$target/bin" "$target/lib"
: >"$target/left-out"

work=$(mktemp -d "${TMPDIR:-/tmp}/fetch-peers.XXXXXX")
trap 'rm -rf "$work"' EXIT

# leave_out PEER REASON
leave_out() {
    echo "$1: $2" | tee -a "$target/left-out"
}

# build PEER VERSION: from its crate
build() {
    cargo install --quiet --locked --root "$target" --target-dir "$work/target" --version "$2" "$1" ||
        leave_out "$1" "cargo install $1 --version $2 fails"
}

# unpack PACKAGE...: as this machine's release has it, else Debian's stable one
unpack() {
    for package; do
        apt-get download -qq "$package" 2>/dev/null || apt-get $own download -qq "$package/stable" || return 1
        dpkg -x "$package"_*.deb root
    done
}

build kanata 1.11.0
build xremap 0.15.17

cd "$work"
if own_lists "$work" "deb stable"; then
    # The library of YAML has its version in its name.
    yaml=$(apt-cache depends interception-tools | sed -n 's/.*Depends: \(libyaml-cpp.*\)/\1/p')
    if unpack interception-tools interception-caps2esc libevdev2 $yaml; then
        # Debian has another name for it.
        cp root/usr/bin/interception "$target/bin/intercept"
        cp root/usr/bin/uinput root/usr/bin/caps2esc "$target/bin"
        cp root/usr/lib/*/libevdev.so.* root/usr/lib/*/libyaml-cpp.so.* "$target/lib"
    else
        leave_out interception-tools "no package of it for this machine"
    fi
    if unpack keyd; then
        cp root/usr/bin/keyd* "$target/bin/keyd"
    else
        leave_out keyd "no package of it for this machine"
    fi
else
    leave_out "interception-tools, keyd" "no packages of Debian here"
fi
leave_out evsieve "neither Debian nor cargo's registry has it"

[ -x "$target/bin/kanata" ] && [ -x "$target/bin/xremap" ]
echo "$target"
