# [[stick]] and [[trigger]]: axes that follow the touch.

case a stick follows the place of the touch
profile super-mario
remove button.1
set dpad.min_force_n = 20
add [[stick]]
add stick = "left"
add centre_radius_mm = 4

0ms x=4 fz=1
1ms x=14 fz=1
2ms x=24 fz=1
3ms y=30 fz=1
4ms y=-14 fz=1
5ms lift

1ms ABS_X 16384
2ms ABS_X 32767
3ms ABS_X 0
3ms ABS_Y -32768
4ms ABS_Y 16384
5ms ABS_Y 0

case a stick starts at 0.3 N and rests below 0.2 N
profile super-mario
remove button.1
set dpad.min_force_n = 20
add [[stick]]
add stick = "right"

0ms x=24 fz=0.29
1ms x=24 fz=0.30
2ms x=24 fz=0.20
3ms x=24 fz=0.19

1ms ABS_RX 32767
3ms ABS_RX 0

case a stick follows the shear
profile super-mario
remove button.1
set dpad.min_force_n = 20
add [[stick]]
add stick = "left"
add from = "shear"
add centre_n = 0.5
add full_n = 2.5

0ms fx=0.5 fz=1
1ms fx=1.5 fz=1
2ms fy=3 fz=1
3ms lift

1ms ABS_X 16384
2ms ABS_X 0
2ms ABS_Y -32768
3ms ABS_Y 0

case a trigger goes with the force, and in its zone only
profile super-mario
remove button.1
set dpad.min_force_n = 20
add [[zone]]
add name = "top"
add from_deg = 45
add to_deg = 135
add [[trigger]]
add trigger = "right"
add from_n = 1
add full_n = 3
add zone = "top"

0ms y=20 fz=1
1ms y=20 fz=2
2ms y=20 fz=3
3ms y=-20 fz=3
4ms lift

1ms ABS_RZ 128
2ms ABS_RZ 255
3ms ABS_RZ 0

case the keyboard has no sticks
profile super-mario
output keyboard
remove button.1
add [[stick]]
add stick = "left"

0ms x=24 fz=1
1ms lift

0ms KEY_RIGHT 1
1ms KEY_RIGHT 0
