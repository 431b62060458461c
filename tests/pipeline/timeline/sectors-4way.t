# Four sectors of 90 degrees; a direction changes more than 8 degrees past its edge.

case the four directions on the gamepad: +x is HAT0X 1, +y is HAT0Y -1
profile super-mario

0ms x=20 fz=1
1ms lift
2ms y=20 fz=1
3ms lift
4ms x=-20 fz=1
5ms lift
6ms y=-20 fz=1
7ms lift

0ms ABS_HAT0X 1
1ms ABS_HAT0X 0
2ms ABS_HAT0Y -1
3ms ABS_HAT0Y 0
4ms ABS_HAT0X -1
5ms ABS_HAT0X 0
6ms ABS_HAT0Y 1
7ms ABS_HAT0Y 0

case the four directions on the keyboard
profile super-mario
output keyboard

0ms x=20 fz=1
1ms y=20 fz=1
2ms x=-20 fz=1
3ms y=-20 fz=1

0ms KEY_RIGHT 1
1ms KEY_RIGHT 0
1ms KEY_UP 1
2ms KEY_UP 0
2ms KEY_LEFT 1
3ms KEY_LEFT 0
3ms KEY_DOWN 1

# One degree each millisecond, from half a degree on: at 53 ms the angle is 53.5 degrees.
case a turn counter-clockwise changes 8 degrees late
profile super-mario

0ms..359ms angle=0.5..359.5 r=20 fz=1

0ms ABS_HAT0X 1
53ms ABS_HAT0X 0
53ms ABS_HAT0Y -1
143ms ABS_HAT0Y 0
143ms ABS_HAT0X -1
233ms ABS_HAT0X 0
233ms ABS_HAT0Y 1
323ms ABS_HAT0Y 0
323ms ABS_HAT0X 1

case a turn clockwise changes 8 degrees late, too
profile super-mario

0ms..359ms angle=-0.5..-359.5 r=20 fz=1

0ms ABS_HAT0X 1
53ms ABS_HAT0X 0
53ms ABS_HAT0Y 1
143ms ABS_HAT0Y 0
143ms ABS_HAT0X -1
233ms ABS_HAT0X 0
233ms ABS_HAT0Y -1
323ms ABS_HAT0Y 0
323ms ABS_HAT0X 1

case without hysteresis the sector's edge itself counts
profile super-mario
set dpad.hysteresis_deg = 0

0ms x=10 y=10 fz=1
1ms x=10 y=10.001 fz=1
2ms x=10 y=10 fz=1
3ms x=10.001 y=10 fz=1

0ms ABS_HAT0X 1
1ms ABS_HAT0X 0
1ms ABS_HAT0Y -1
3ms ABS_HAT0Y 0
3ms ABS_HAT0X 1

case a jump to the other side turns the hat without a stop between
profile super-mario

0ms x=20 fz=1
1ms x=-20 fz=1

0ms ABS_HAT0X 1
1ms ABS_HAT0X -1

case trembling about a diagonal changes nothing
profile super-mario

0ms..6ms angle=38..52 r=20 fz=1
7ms..13ms angle=52..38 r=20 fz=1

0ms ABS_HAT0X 1

case a touch that starts anew forgets the old direction
profile super-mario

0ms angle=40 r=20 fz=1
1ms angle=50 r=20 fz=1
2ms lift
3ms angle=50 r=20 fz=1

0ms ABS_HAT0X 1
2ms ABS_HAT0X 0
3ms ABS_HAT0Y -1

case rotation turns the sectors counter-clockwise
profile super-mario
set dpad.rotation_deg = 30

0ms angle=74.5 r=20 fz=1
1ms lift
2ms angle=75.5 r=20 fz=1
3ms lift
4ms angle=-14.5 r=20 fz=1
5ms lift
6ms angle=-15.5 r=20 fz=1

0ms ABS_HAT0X 1
1ms ABS_HAT0X 0
2ms ABS_HAT0Y -1
3ms ABS_HAT0Y 0
4ms ABS_HAT0X 1
5ms ABS_HAT0X 0
6ms ABS_HAT0Y 1
