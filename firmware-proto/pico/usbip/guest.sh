#!/bin/bash
# In the guest: the real USB core takes the board from the server at the other end of a connection, its drivers make nodes, and the
# program plays on them. ./check.mjs reads what is said here.
#
#   guest.sh PROGRAM PORT SET_RATE
program="$1" port="$2" set_rate="$3"
busybox ifconfig lo up
busybox ifconfig eth0 10.0.2.15 netmask 255.255.255.0 up
scratch=/run/scratch
mkdir -p "$scratch/home"
export HOME="$scratch/home"

# Waits for a state, of which a test is this command.
wait_for() {
  local what="$1" tries
  shift
  for ((tries = 0; tries < 300; tries++)); do
    "$@" && return
    sleep 0.1
  done
  echo "guest: $what did not come"
  return 1
}

attach() {
  exec 3<>"/dev/tcp/10.0.2.2/$port" || return
  # What asks for device 1-1: two words of 16 bits, one of 32, a name of 32 bytes.
  { printf '\x01\x11\x80\x03\x00\x00\x00\x00'; printf '1-1'; head -c 29 /dev/zero; } >&3
  dd bs=1 count=320 <&3 of="$scratch/imported" 2>/dev/null
  echo "0 3 65538 2" >/sys/devices/platform/vhci_hcd.0/attach || return
  exec 3>&-
}

detach() { echo 0 >/sys/devices/platform/vhci_hcd.0/detach; }
nodes() { [ -c /dev/ttyACM0 ] && ls /dev/hidraw* >/dev/null 2>&1; }
no_nodes() { ! [ -e /dev/ttyACM0 ] && ! ls /dev/hidraw* >/dev/null 2>&1; }
gamepad() { sed -n '/X-Box 360/,/^$/s/.*Handlers=.*\(event[0-9]*\).*/\1/p' /proc/bus/input/devices | tail -n 1; }
has_gamepad() { [ -n "$(gamepad)" ]; }

# A press or its end is an event and a report of 24 bytes each.
presses() { echo $(($(stat -c %s "$scratch/events") / 48)); }
has_presses() { [ "$(presses)" -ge "$1" ]; }
# The value of the last one.
is_held() { [ "$(tail -c 48 "$scratch/events" | od -An -td4 -j 20 -N 4 | tr -d ' ')" = 1 ]; }
is_free() { ! is_held; }

# Plays with a pad: three presses, then what else is asked, and shows the events of the gamepad.
play() {
  local name="$1" pad="$2" playing reading
  shift 2
  : >"$scratch/events"
  "$program" run --pad "$pad" --output uinput >"$scratch/run" 2>&1 &
  playing=$!
  if wait_for "the gamepad by $name" has_gamepad; then
    cat "/dev/input/$(gamepad)" >"$scratch/events" &
    reading=$!
    wait_for "three presses by $name" has_presses 6 && { [ $# = 0 ] || "$@"; }
    "$program" ctl status | sed "s/^/$name: status: /"
    kill "$reading"
    echo "$name: events: $(base64 -w 0 "$scratch/events")"
  fi
  kill "$playing"
  wait "$playing"
  sed "s/^/$name: said: /" "$scratch/run"
}

# Pulls the pad out while it is pressed, and puts it back.
pull() {
  local before
  wait_for "a press" is_held
  before="$(presses)"
  detach
  wait_for "the end of the nodes" no_nodes
  wait_for "a release" is_free && echo "guest: released when it was pulled out"
  attach
  wait_for "a node of each kind" nodes
  wait_for "presses after it" has_presses $((before + 5)) && echo "guest: plays when it is back"
}

attach || { echo "guest: no connection"; exit 1; }
wait_for "a node of each kind" nodes || { dmesg | tail -n 20; exit 1; }
for file in /sys/bus/usb/devices/1-1/{manufacturer,product,serial,speed}; do echo "guest: $(basename "$file"): $(cat "$file")"; done
for link in /sys/bus/usb/devices/1-1:*/driver; do
  echo "guest: interface $(basename "$(dirname "$link")"): $(basename "$(readlink "$link")")"
done
# The serial port echoes until it is told not to, and a zero ends what came of it.
exec 4<>/dev/ttyACM0
stty -F /dev/ttyACM0 raw -echo 115200
printf '%b' "\\x00$set_rate" >&4
sleep 0.3
exec 4>&-
"$program" devices 2>&1 | sed 's/^/devices: /'
play auto auto pull
play serial serial:/dev/ttyACM0
