# [access], dwell and sticky keys: for hands that press what they do not mean.

case Slow Keys: a press counts when it has lasted 150 ms
profile contra
add [access]
add slow_ms = 150

0ms fz=2.5
149ms fz=2.5
150ms fz=2.5
160ms lift

150ms BTN_SOUTH 1
160ms BTN_SOUTH 0

case Slow Keys: one of 149 ms does not
profile contra
add [access]
add slow_ms = 150

0ms fz=2.5
149ms fz=2.5
149ms lift
200ms fz=2.5
300ms lift

nothing

case Slow Keys: a long press is long from where it counts
profile super-mario
add [access]
add slow_ms = 100

0ms fz=2.5
100ms fz=2.5
499ms fz=2.5
500ms fz=2.5
501ms lift

500ms BTN_EAST 1
501ms BTN_EAST 0

case Bounce Keys: a press 299 ms after the last one does not count, one at 300 ms does
profile contra
add [access]
add bounce_ms = 300

0ms fz=2.5
10ms lift
309ms fz=2.5
309ms lift
310ms fz=2.5
311ms lift

0ms BTN_SOUTH 1
10ms BTN_SOUTH 0
310ms BTN_SOUTH 1
311ms BTN_SOUTH 0

case Bounce Keys: who presses too soon and keeps pressing is heard when the time is over
profile contra
add [access]
add bounce_ms = 300

0ms fz=2.5
10ms lift
200ms fz=2.5
400ms fz=2.5
401ms lift
402ms fz=2.5
403ms lift

0ms BTN_SOUTH 1
10ms BTN_SOUTH 0
400ms BTN_SOUTH 1
401ms BTN_SOUTH 0

case Bounce Keys: a thumb that crosses the centre goes on with its hold
profile super-mario
remove button.1
add [access]
add bounce_ms = 300

0ms..500ms x=20 fz=1
501ms..550ms x=0 fz=1
551ms..1200ms x=20 fz=1
1201ms lift

0ms ABS_HAT0X 1
501ms ABS_HAT0X 0
801ms ABS_HAT0X 1
1201ms ABS_HAT0X 0

case Slow Keys: a thumb that strays and stays on the pad waits as long as it was away
profile super-mario
remove button.1
add [access]
add slow_ms = 300

0ms..500ms x=20 fz=1
501ms..600ms x=0 fz=1
601ms..1200ms x=20 fz=1
1201ms lift
1300ms..1700ms x=20 fz=1
1701ms lift

300ms ABS_HAT0X 1
501ms ABS_HAT0X 0
701ms ABS_HAT0X 1
1201ms ABS_HAT0X 0
1600ms ABS_HAT0X 1
1701ms ABS_HAT0X 0

case Bounce Keys: another button may follow at once
profile contra
add [access]
add bounce_ms = 300

0ms fz=2.5
10ms fz=1
11ms fz=1 fy=1.5

0ms BTN_SOUTH 1
10ms BTN_SOUTH 0
11ms BTN_EAST 1

case dwell: a finger that rests for 800 ms presses
profile pointer
remove button.1
add [[button]]
add force = "fz"
add press_n = 0.6
add dwell_ms = 800
add out = { pointer = "BTN_LEFT" }

0ms x=1 fz=0.6
799ms x=3.9 fz=0.6
800ms x=3.9 fz=0.6
900ms x=4.5 fz=0.5
901ms fz=0.4

800ms BTN_LEFT 1
901ms BTN_LEFT 0

case dwell: one that moves by more than 3 mm begins anew
profile pointer
set pointer.centre_radius_mm = 28
set pointer.full_radius_mm = 30
remove button.1
add [[button]]
add force = "fz"
add press_n = 0.6
add dwell_ms = 800
add out = { pointer = "BTN_LEFT" }

0ms x=1 fz=0.6
700ms x=4.1 fz=0.6
1499ms x=4.1 fz=0.6
1500ms x=4.1 fz=0.6

1500ms BTN_LEFT 1

case sticky: latched until the next press has ended
profile contra
set button.2.out = { gamepad = "BTN_TL", keyboard = "KEY_LEFTSHIFT", sticky = true }

0ms fy=1.5 fz=1
10ms fz=1
20ms fz=2.5
30ms fz=1
31ms fz=1

0ms BTN_TL 1
20ms BTN_SOUTH 1
30ms BTN_SOUTH 0
31ms BTN_TL 0

case sticky: two presses lock, a third lets go
profile contra
set button.2.out = { gamepad = "BTN_TL", keyboard = "KEY_LEFTSHIFT", sticky = true }

0ms fy=1.5 fz=1
10ms fz=1
20ms fy=1.5 fz=1
30ms fz=2.5
40ms fz=1
50ms fy=1.5 fz=1

0ms BTN_TL 1
30ms BTN_SOUTH 1
40ms BTN_SOUTH 0
50ms BTN_TL 0

case sticky: a direction is an action, too
profile contra
set button.2.out = { gamepad = "BTN_TL", keyboard = "KEY_LEFTSHIFT", sticky = true }

0ms fy=1.5 fz=1
1ms lift
10ms x=20 fz=1
20ms lift
21ms lift

0ms BTN_TL 1
10ms ABS_HAT0X 1
20ms ABS_HAT0X 0
21ms BTN_TL 0

case sticky: a fault lets go
profile contra
set button.2.out = { gamepad = "BTN_TL", keyboard = "KEY_LEFTSHIFT", sticky = true }

0ms fy=1.5 fz=1
1ms lift
2ms fault

0ms BTN_TL 1
2ms BTN_TL 0

case a tremor on a boundary is calmed
profile super-mario
set dpad.hysteresis_deg = 0
add [access]
add tremor_hz = 0.5
add tremor_per_mm = 0

0ms..500ms angle=30 r=20 fz=1
501ms..540ms angle=30..50 r=20 fz=1
541ms..580ms angle=50..30 r=20 fz=1
581ms..620ms angle=30..50 r=20 fz=1

0ms ABS_HAT0X 1

case Slow Keys: a direction counts when it has lasted 150 ms
profile tank-battle
add [access]
add slow_ms = 150

0ms x=20 fz=1
149ms x=20 fz=1
150ms x=20 fz=1
200ms y=20 fz=1
349ms y=20 fz=1
350ms y=20 fz=1
400ms lift

150ms ABS_HAT0X 1
200ms ABS_HAT0X 0
350ms ABS_HAT0Y -1
400ms ABS_HAT0Y 0

case Bounce Keys: a direction that comes back within 300 ms does not count, another one does
profile tank-battle
add [access]
add bounce_ms = 300

0ms x=20 fz=1
100ms lift
399ms x=20 fz=1
450ms lift
500ms y=20 fz=1
600ms lift
760ms x=20 fz=1
800ms lift

0ms ABS_HAT0X 1
100ms ABS_HAT0X 0
500ms ABS_HAT0Y -1
600ms ABS_HAT0Y 0
760ms ABS_HAT0X 1
800ms ABS_HAT0X 0
