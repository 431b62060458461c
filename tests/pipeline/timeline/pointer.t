# The pointer's velocity: REL_X and REL_Y with counts per second, stated again whenever it changes.

case the velocity grows from the edge of the centre to the full radius
profile pointer
set pointer.full_radius_mm = 25

0ms x=5 fz=1
1ms x=5.5 fz=1
2ms x=15 fz=1
3ms x=24.99 fz=1
4ms x=25 fz=1
5ms x=29 fz=1
6ms lift

1ms REL_X 1
2ms REL_X 200
3ms REL_X 799
4ms REL_X 800
6ms REL_X 0

case up on the plate is up on the screen
profile pointer

0ms angle=90 r=24 fz=1
1ms angle=180 r=24 fz=1
2ms angle=270 r=24 fz=1
3ms angle=45 r=24 fz=1

0ms REL_Y -800
1ms REL_Y 0
1ms REL_X -800
2ms REL_X 0
2ms REL_Y 800
3ms REL_X 566
3ms REL_Y -566

case it starts at the force that starts it and goes on down to the one that ends it
profile pointer
set pointer.min_force_n = 0.5
set pointer.release_force_n = 0.25

0ms x=24 fz=0.4999
1ms x=24 fz=0.5
2ms x=24 fz=0.25
3ms x=24 fz=0.2499
4ms x=24 fz=0.4999
5ms x=24 fz=0.5

1ms REL_X 800
3ms REL_X 0
5ms REL_X 800

case over the centre it rests and goes on without a new start
profile pointer

0ms x=24 fz=0.3
1ms x=0 fz=0.25
2ms x=-24 fz=0.25

0ms REL_X 800
1ms REL_X 0
2ms REL_X -800

case a fault stops it and it must start again
profile pointer

0ms x=24 fz=1
1ms fault
2ms x=24 fz=0.25
3ms x=24 fz=0.3

0ms REL_X 800
1ms REL_X 0
3ms REL_X 800

case a press holds the button on the way
profile pointer

0ms x=24 fz=1
10ms x=24 fz=2
11ms x=24 fz=1.4
12ms x=24 fz=1.399
13ms lift

0ms REL_X 800
10ms BTN_LEFT 1
12ms BTN_LEFT 0
13ms REL_X 0

case buttons of the pointer are the same with the keyboard's bindings
profile pointer
output keyboard

0ms fz=2
1ms lift

0ms BTN_LEFT 1
1ms BTN_LEFT 0

case another profile stops it
profile pointer

0ms x=24 fz=1
1ms switch super-mario
2ms x=24 fz=1

0ms REL_X 800
2ms REL_X 0
2ms ABS_HAT0X 1
