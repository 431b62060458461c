# Diagonal zones of 45 degrees (22.5 to 67.5, ...) hold two directions; changes come 8 degrees late.

case a turn counter-clockwise
profile contra

0ms..359ms angle=0..359 r=20 fz=1

0ms ABS_HAT0X 1
31ms ABS_HAT0Y -1
76ms ABS_HAT0X 0
121ms ABS_HAT0X -1
166ms ABS_HAT0Y 0
211ms ABS_HAT0Y 1
256ms ABS_HAT0X 0
301ms ABS_HAT0X 1
346ms ABS_HAT0Y 0

case a turn clockwise, on the keyboard
profile contra
output keyboard

0ms..180ms angle=90..-90 r=20 fz=1

0ms KEY_UP 1
31ms KEY_RIGHT 1
76ms KEY_UP 0
121ms KEY_DOWN 1
166ms KEY_RIGHT 0

case fresh touches on either side of a zone's edge
profile contra

0ms angle=22.4 r=20 fz=1
1ms lift
2ms angle=22.6 r=20 fz=1
3ms lift
4ms angle=67.4 r=20 fz=1
5ms lift
6ms angle=67.6 r=20 fz=1

0ms ABS_HAT0X 1
1ms ABS_HAT0X 0
2ms ABS_HAT0X 1
2ms ABS_HAT0Y -1
3ms ABS_HAT0X 0
3ms ABS_HAT0Y 0
4ms ABS_HAT0X 1
4ms ABS_HAT0Y -1
5ms ABS_HAT0X 0
5ms ABS_HAT0Y 0
6ms ABS_HAT0Y -1

case leaving a diagonal needs the hysteresis, too
profile contra

0ms angle=45 r=20 fz=1
1ms angle=14.6 r=20 fz=1
2ms angle=14.4 r=20 fz=1

0ms ABS_HAT0X 1
0ms ABS_HAT0Y -1
2ms ABS_HAT0Y 0
