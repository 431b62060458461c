# hysteresis_mm: along the arc a direction reaches as far at any distance from the centre.

case near the centre 2.5 mm are more than 8 degrees: 15.9 at 9 mm
profile super-mario
set dpad.hysteresis_mm = 2.5

0ms angle=0 r=9 fz=1
1ms angle=60.8 r=9 fz=1
2ms angle=61 r=9 fz=1
3ms angle=29.2 r=9 fz=1
4ms angle=29 r=9 fz=1

0ms ABS_HAT0X 1
2ms ABS_HAT0X 0
2ms ABS_HAT0Y -1
4ms ABS_HAT0Y 0
4ms ABS_HAT0X 1

case far out 8 degrees are more than 2.5 mm: 3.5 mm at 25 mm
profile super-mario
set dpad.hysteresis_mm = 2.5

0ms angle=0 r=25 fz=1
1ms angle=52.9 r=25 fz=1
2ms angle=53.1 r=25 fz=1

0ms ABS_HAT0X 1
2ms ABS_HAT0X 0
2ms ABS_HAT0Y -1

case without the key it is as it was
profile super-mario
set dpad.hysteresis_mm = 0

0ms angle=0 r=9 fz=1
1ms angle=53.1 r=9 fz=1

0ms ABS_HAT0X 1
1ms ABS_HAT0X 0
1ms ABS_HAT0Y -1

case close to the centre it ends at the middle of the next zone
profile super-mario
set dpad.hysteresis_mm = 10
set dpad.centre_radius_mm = 3

0ms angle=0 r=4 fz=1
1ms angle=89.9 r=4 fz=1
2ms angle=90.1 r=4 fz=1

0ms ABS_HAT0X 1
2ms ABS_HAT0X 0
2ms ABS_HAT0Y -1

case a touch 1 mm to and fro on a boundary changes nothing
profile super-mario
set dpad.hysteresis_mm = 2.5

0ms angle=30 r=9 fz=1
1ms..20ms angle=38.6..51.4 r=9 fz=1
21ms..40ms angle=51.4..38.6 r=9 fz=1
41ms..60ms angle=38.6..51.4 r=9 fz=1

0ms ABS_HAT0X 1
