#!/bin/busybox sh
# First process of the guest. Serial port 0 is the kernel's, serial port 1 carries what the command says.
# The host's own root lies read-only under a throw-away upper layer, so programs run in place and no write reaches it.
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root TERM=dumb
b=/bin/busybox
load_modules() {
    while read -r module; do
        $b insmod "/modules/$module" || return 1
    done </modules/order
}
run() {
    load_modules &&
        $b mkdir -p /dev/pts /dev/shm &&
        $b mount -t devpts pts /dev/pts &&
        $b mount -t tmpfs shm /dev/shm &&
        $b mount -t 9p -o trans=virtio,version=9p2000.L,ro,msize=262144,cache=loose root /lower &&
        $b mount -t tmpfs upper /upper &&
        $b mkdir /upper/files /upper/work &&
        $b mount -t overlay -o lowerdir=/lower,upperdir=/upper/files,workdir=/upper/work root /root || return 125
    for d in /proc /sys /dev /dev/pts /dev/shm; do $b mount -o bind $d /root$d || return 125; done
    $b mount -t tmpfs run /root/run || return 125
    $b mkdir -p /root/run/user /root/run/scratch
    $b cp /command /root/run/command
    echo "guest: kernel $($b uname -r), up for $($b cut -d ' ' -f 1 /proc/uptime) s"
    TMPDIR=/run/scratch XDG_RUNTIME_DIR=/run/user $b chroot /root /run/command </dev/null
}
$b mount -t proc proc /proc
$b mount -t sysfs sys /sys
$b mount -t devtmpfs dev /dev
run >/dev/ttyS1 2>&1
echo "guest: exit code $?" >/dev/ttyS1
$b poweroff -f
