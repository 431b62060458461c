# Pressing jumps, pushing forward fires, both as long as they last, while the direction goes on.

case jump follows the normal force
profile contra

0ms fz=1.999
1ms fz=2
900ms fz=1.4
901ms fz=1.399

1ms BTN_SOUTH 1
901ms BTN_SOUTH 0

case fire follows the force forward
profile contra

0ms fz=1 fy=1.199
1ms fz=1 fy=1.2
2ms fz=1 fy=0.801
3ms fz=1 fy=0.799

1ms BTN_EAST 1
3ms BTN_EAST 0

case pushing backward does not fire
profile contra

0ms..20ms fz=1 fy=-3
21ms lift

nothing

case the sign of the force chooses the direction that counts
profile contra
set button.1.force = "-fy"
set button.2.force = "-fx"

0ms fz=1 fx=3 fy=3
1ms fz=1 fx=-3 fy=3
2ms fz=1 fx=3 fy=-3

1ms BTN_EAST 1
2ms BTN_EAST 0
2ms BTN_SOUTH 1

case running, aiming, jumping and firing together
profile contra
output keyboard

0ms angle=45 r=20 fz=1
50ms angle=45 r=20 fz=2.2
80ms angle=45 r=20 fz=2.2 fy=1.3
200ms angle=0 r=20 fz=2.2 fy=1.3
300ms angle=0 r=20 fz=1 fy=1.3
400ms lift

0ms KEY_RIGHT 1
0ms KEY_UP 1
50ms KEY_Z 1
80ms KEY_X 1
200ms KEY_UP 0
300ms KEY_Z 0
400ms KEY_RIGHT 0
400ms KEY_X 0
