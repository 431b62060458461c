# Diagonal zones of 30 degrees (30 to 60, ...) keep the last direction.

case a turn counter-clockwise keeps each direction through the diagonal
profile tetris

0ms..359ms angle=0.5..359.5 r=20 fz=1

0ms ABS_HAT0X 1
60ms ABS_HAT0X 0
60ms ABS_HAT0Y -1
150ms ABS_HAT0Y 0
150ms ABS_HAT0X -1
240ms ABS_HAT0X 0
240ms ABS_HAT0Y 1
330ms ABS_HAT0Y 0
330ms ABS_HAT0X 1

case and back
profile tank-battle

0ms..89ms angle=89.5..0.5 r=20 fz=1

0ms ABS_HAT0Y -1
60ms ABS_HAT0Y 0
60ms ABS_HAT0X 1

case a touch that starts in a diagonal zone takes the nearest direction
profile tetris

0ms angle=44 r=20 fz=1
1ms angle=46 r=20 fz=1
2ms lift
3ms angle=46 r=20 fz=1
4ms angle=44 r=20 fz=1
5ms lift
6ms angle=225.5 r=20 fz=1

0ms ABS_HAT0X 1
2ms ABS_HAT0X 0
3ms ABS_HAT0Y -1
5ms ABS_HAT0Y 0
6ms ABS_HAT0Y 1

case a narrow diagonal keeps a direction as far as it reaches
profile tetris
set dpad.diagonal_deg = 6

0ms angle=0 r=20 fz=1
1ms angle=47.9 r=20 fz=1
2ms angle=48.1 r=20 fz=1

0ms ABS_HAT0X 1
2ms ABS_HAT0X 0
2ms ABS_HAT0Y -1

case a jump to a diagonal on the far side takes the nearest direction there
profile tetris

0ms angle=0 r=20 fz=1
1ms angle=130 r=20 fz=1

0ms ABS_HAT0X 1
1ms ABS_HAT0X 0
1ms ABS_HAT0Y -1
