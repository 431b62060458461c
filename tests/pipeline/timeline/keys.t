# Names with + between them go down and up together, in the order in which they are written.

case two keys at once
profile contra
output keyboard
set button.1.out = { gamepad = "BTN_SOUTH", keyboard = "KEY_LEFTCTRL+KEY_C" }

0ms fz=2
50ms fz=1

0ms KEY_LEFTCTRL 1
0ms KEY_C 1
50ms KEY_LEFTCTRL 0
50ms KEY_C 0

case a direction may be several keys
profile contra
output keyboard
set dpad.keyboard = { right = "KEY_LEFTSHIFT+KEY_D" }

0ms x=20 fz=1
50ms lift

0ms KEY_LEFTSHIFT 1
0ms KEY_D 1
50ms KEY_LEFTSHIFT 0
50ms KEY_D 0

case a key that another button holds, too, stays down
profile contra
output keyboard
set button.1.out = { gamepad = "BTN_SOUTH", keyboard = "KEY_LEFTSHIFT+KEY_C" }
set button.2.out = { gamepad = "BTN_EAST", keyboard = "KEY_LEFTSHIFT+KEY_D" }

0ms fz=2
50ms fz=2 fy=2
100ms fz=1 fy=2
150ms lift

0ms KEY_LEFTSHIFT 1
0ms KEY_C 1
50ms KEY_D 1
100ms KEY_C 0
150ms KEY_LEFTSHIFT 0
150ms KEY_D 0
