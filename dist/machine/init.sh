#!/bin/busybox sh
# First process of the machine. A file system of Debian lies read-only under a throw-away upper layer; its systemd goes on from here.
b=/bin/busybox
$b mount -t proc proc /proc
$b mount -t sysfs sys /sys
$b mount -t devtmpfs dev /dev
while read -r module; do $b insmod "/modules/$module"; done </modules/order
$b mount -t 9p -o trans=virtio,version=9p2000.L,ro,msize=262144,cache=loose root /lower
$b mount -t tmpfs upper /upper
$b mkdir /upper/files /upper/work
$b mount -t overlay -o "lowerdir=/lower$($b cat /base),upperdir=/upper/files,workdir=/upper/work" root /root
$b cp -a /given/. /root/
$b chroot /root /usr/sbin/useradd --create-home --shell /bin/bash player
exec $b switch_root /root /sbin/init
