#!/busybox sh
# First process of the guest. Its root is a scratch directory of the host; the command to run is /command.
# The host's own root lies read-only under a throw-away upper layer, so programs run in place and no write reaches it.
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root TERM=dumb
b=/busybox
run() {
    $b mount -t proc proc /proc &&
        $b mount -t sysfs sys /sys &&
        { [ -c /dev/null ] || $b mount -t devtmpfs dev /dev; } &&
        $b mkdir -p /dev/pts /dev/shm &&
        $b mount -t devpts pts /dev/pts &&
        $b mount -t tmpfs shm /dev/shm &&
        $b mount -t hostfs -o ro,/ none /lower &&
        $b mount -t tmpfs upper /upper &&
        $b mkdir /upper/files /upper/work &&
        $b mount -t overlay -o lowerdir=/lower,upperdir=/upper/files,workdir=/upper/work root /root || return 125
    for d in /proc /sys /dev /dev/pts /dev/shm; do $b mount -o bind $d /root$d || return 125; done
    $b mount -t tmpfs run /root/run || return 125
    # SDL takes this directory for the sign that devices are to be found in sysfs.
    $b mkdir -p /root/run/udev /root/run/user /root/run/scratch
    $b cp /command /root/run/command
    TMPDIR=/run/scratch XDG_RUNTIME_DIR=/run/user $b chroot /root /run/command </dev/null
}
run >/dev/tty0 2>&1
echo $? >/exit-code
$b sync
$b poweroff -f
