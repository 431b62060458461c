# What `ctl watch` is told.

case a button's presses, accepted and rejected; directions without Slow and Bounce Keys are not told
profile contra
set button.1.dwell_ms = 100
watch presses

0ms x=20 fz=2.5
99ms x=20 fz=2.5
100ms x=20 fz=2.5
110ms lift
200ms x=20 fz=2.5
299ms lift

0ms ABS_HAT0X 1
100ms BTN_SOUTH 1
100ms accepted button 1
110ms ABS_HAT0X 0
110ms BTN_SOUTH 0
200ms ABS_HAT0X 1
299ms ABS_HAT0X 0
299ms rejected button 1 dwell

case directions that Slow Keys reject, each once
profile contra
remove button.1
add [access]
add slow_ms = 150
watch presses

0ms..149ms x=20 fz=1
149ms lift
300ms..449ms x=-20 fz=1
450ms..598ms angle=135 r=20 fz=1
599ms x=-20 fz=1
700ms lift

149ms rejected right slow
450ms ABS_HAT0X -1
450ms accepted left
599ms rejected up slow
700ms ABS_HAT0X 0

case directions that Bounce Keys reject, and one that lasts
profile super-mario
remove button.1
add [access]
add bounce_ms = 300
watch presses

0ms x=20 fz=1
100ms lift
300ms..350ms x=20 fz=1
351ms lift
380ms..800ms x=20 fz=1
801ms lift
802ms x=0 y=20 fz=1

0ms ABS_HAT0X 1
0ms accepted right
100ms ABS_HAT0X 0
351ms rejected right bounce
400ms ABS_HAT0X 1
400ms accepted right
801ms ABS_HAT0X 0
802ms ABS_HAT0Y -1
802ms accepted up

case a hand that rests is told when it has lain for rest_ms, once after a lift or a touch
profile super-mario
remove button.1
add [access]
add rest_n = 0.5
add rest_ms = 400
watch presses

0ms..5000ms x=20 fz=0.3
5001ms lift
5100ms..5499ms x=20 fz=0.3
5499ms lift
6000ms..6400ms x=20 fz=0.3
6401ms x=20 fz=1.5
6500ms..9000ms x=20 fz=0.4

400ms rest
6400ms rest
6401ms ABS_HAT0X 1
6500ms ABS_HAT0X 0
6900ms rest

case a quick press on its way to its force is no hand that rests
profile super-mario
remove button.1
add [access]
add rest_n = 0.5
watch presses

0ms..499ms x=20 fz=0.16..0.49
500ms..2000ms x=20 fz=1
2001ms lift

500ms ABS_HAT0X 1
2001ms ABS_HAT0X 0

