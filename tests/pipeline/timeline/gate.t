# A direction starts at min_force_n and centre_radius_mm, and ends below the release force, the inner radius or a lift.

case it starts exactly at both thresholds
profile super-mario
set dpad.min_force_n = 0.5

0ms x=8 fz=0.4999
1ms x=7.999 fz=0.5
2ms x=8 fz=0.5

2ms ABS_HAT0X 1

case it goes on down to the inner radius and ends just below
profile super-mario

0ms x=20 fz=1
1ms x=6.5 fz=1
2ms x=6.499 fz=1

0ms ABS_HAT0X 1
2ms ABS_HAT0X 0

case once ended it needs the outer radius again
profile super-mario

0ms x=20 fz=1
1ms x=6 fz=1
2ms x=7.999 fz=1
3ms x=8 fz=1

0ms ABS_HAT0X 1
1ms ABS_HAT0X 0
3ms ABS_HAT0X 1

case it goes on down to the release force and ends just below
profile super-mario
set dpad.min_force_n = 0.5
set dpad.release_force_n = 0.25

0ms x=20 fz=1
1ms x=20 fz=0.25
2ms x=20 fz=0.2499
3ms x=20 fz=0.4999
4ms x=20 fz=0.5

0ms ABS_HAT0X 1
2ms ABS_HAT0X 0
4ms ABS_HAT0X 1

case a lift ends it
profile super-mario

0ms y=-20 fz=1
10ms lift
11ms lift

0ms ABS_HAT0Y 1
10ms ABS_HAT0Y 0

case pulling never steers
profile super-mario

0ms x=20 fz=-3

nothing

case the centre never steers, however hard the press
profile super-mario
set button.1.press_n = 40

0ms fz=30
1ms x=1 y=-1 fz=30

nothing
