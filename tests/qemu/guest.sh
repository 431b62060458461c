# Debian's own kernel in QEMU, for the scripts that source this: ./run, and firmware-proto/pico/usbip/run.
#
# A guest has the host's files, read-only, and runs one command on them. No rights are needed, and no KVM: every instruction is
# emulated. Needs Debian or a relative of it, and some packages (it says which are missing, and installs nothing). The kernel's
# package is downloaded once, to ${XDG_CACHE_HOME:-~/.cache}/tactpad/debian-kernel; nothing of it is installed.
PATH="$PATH:/usr/sbin:/sbin"

readonly DOWNLOAD_LIMIT_S=300
readonly MEMORY_MIB=512
readonly QEMU_FOLDER="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"

cache="${XDG_CACHE_HOME:-$HOME/.cache}/tactpad/debian-kernel"
work="$(mktemp -d "${TMPDIR:-/tmp}/tactpad-qemu.XXXXXX")"
trap 'rm -rf "$work"' EXIT

check_programs() {
  local missing=() program package
  while read -r program package; do
    command -v "$program" >/dev/null || missing+=("$package")
  done <<'NEEDED'
qemu-system-x86_64 qemu-system-x86
busybox busybox-static
cpio cpio
depmod kmod
xz xz-utils
apt-get apt
dpkg-deb dpkg
NEEDED
  if [ ${#missing[@]} -gt 0 ]; then
    echo "missing: apt-get install --no-install-recommends ${missing[*]}" >&2
    exit 2
  fi
}

# Sets `version` and `kernel`, a folder with the unpacked package; fetches it if there is none.
find_kernel() {
  mkdir -p "$cache"
  kernel="$(find "$cache" -maxdepth 2 -name complete -printf '%h\n' | sort -V | tail -n 1)"
  if [ -z "$kernel" ]; then
    fetch_kernel
  fi
  version="$(basename "$kernel")"
}

fetch_kernel() {
  local package
  # The package of no version depends on that of the present one. The cloud kernel would have no uinput.
  package="$(apt-cache depends linux-image-amd64 2>/dev/null | sed -n 's/^ *Depends: \(linux-image-[0-9].*\)/\1/p' |
    tail -n 1)"
  if [ -z "$package" ]; then
    echo "no package linux-image-amd64 is known: apt-get update" >&2
    exit 2
  fi
  echo "downloading $package to $cache"
  mkdir -p "$work/package"
  if ! (cd "$work/package" && timeout "$DOWNLOAD_LIMIT_S" apt-get -qq download "$package" 2>"$work/apt"); then
    cat "$work/apt" >&2
    echo "the kernel's package did not come: apt-get update, then again" >&2
    exit 2
  fi
  kernel="$cache/${package#linux-image-}"
  rm -rf "$kernel"
  mkdir -p "$kernel"
  dpkg-deb -x "$work/package"/*.deb "$kernel"
  depmod -b "$kernel" "${package#linux-image-}"
  unpack_image "$kernel/boot/vmlinuz-${package#linux-image-}" "$kernel/image"
  touch "$kernel/complete"
}

# An image that need not unpack itself saves five emulated seconds. The header says where the packed one lies: after
# its sectors (0x1f1), at an offset (0x248), so many bytes (0x24c). Source: Linux, Documentation/x86/boot.rst.
unpack_image() {
  local packed="$1" sectors offset length
  sectors="$(od -An -tu1 -j $((0x1f1)) -N 1 "$packed")"
  read -r offset length < <(od -An -tu4 -j $((0x248)) -N 8 "$packed")
  head -c $(((sectors + 1) * 512 + offset + length)) "$packed" | tail -c "$length" >"$work/payload"
  # After the stream lie four more bytes. What is not packed by xz starts as it is.
  xz -dc --single-stream "$work/payload" >"$2" 2>/dev/null || cp "$packed" "$2"
}

# The first file system but for the command: busybox, the modules in their order, and the first process.
make_first_root() {
  local root="$work/root" file name
  mkdir -p "$root"/{bin,dev,proc,sys,lower,upper,root,modules}
  cp "$(command -v busybox)" "$root/bin/busybox"
  cp "$QEMU_FOLDER/init.sh" "$root/init"
  chmod +x "$root/init"
  for name in "${MODULES[@]}"; do
    modprobe -d "$kernel" -S "$version" --show-depends "$name"
  done | sed -n 's/^insmod \([^ ]*\).*/\1/p' | awk '!seen[$0]++' >"$work/modules"
  while read -r file; do
    name="$(basename "$file" .xz)"
    case "$file" in
      *.xz) xz -dc "$file" >"$root/modules/$name" ;;
      *) cp "$file" "$root/modules/$name" ;;
    esac
    echo "$name" >>"$root/modules/order"
  done <"$work/modules"
}

# Boots the guest, for so many seconds at most, with these further options of QEMU; it runs $work/root/command. What it said is in
# $work/said and $work/console.
boot_guest() {
  local limit_s="$1"
  shift
  (cd "$work/root" && find . | LC_ALL=C sort | cpio -o -H newc -R 0:0 --quiet) >"$work/initrd"
  : >"$work/said"
  # A processor without AVX: emulated, its wide registers cost more than they save.
  timeout -k 2 "$limit_s" nice -n 10 qemu-system-x86_64 -M pc -accel tcg -cpu Nehalem -smp 1 -m "$MEMORY_MIB" \
    -nodefaults -no-user-config -display none -no-reboot -kernel "$kernel/image" -initrd "$work/initrd" \
    -append 'console=ttyS0 quiet loglevel=4 panic=-1 tsc=reliable no_timer_check nokaslr mitigations=off audit=0' \
    -serial "file:$work/console" -serial "file:$work/said" \
    -fsdev local,id=root,path=/,security_model=none,readonly=on,multidevs=remap \
    -device virtio-9p-pci,fsdev=root,mount_tag=root "$@" </dev/null >"$work/emulator" 2>&1 || true
  tr -d '\r' <"$work/said" >"$work/said.plain"
}
