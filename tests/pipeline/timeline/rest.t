# rest_n: a hand that rests on the pad is no touch.

case light load is no touch, however long it lasts
profile super-mario
add [access]
add rest_n = 0.5

0ms..2000ms x=20 fz=0.45
2001ms lift

nothing

case load that comes by less than 1 N/s is no touch
profile super-mario
add [access]
add rest_n = 0.5

0ms..3000ms x=20 fz=0..2.9
3001ms lift

nothing

case a quick finger on a resting hand is a touch, and ends at two thirds of the force that began it
profile super-mario
remove button.1
add [access]
add rest_n = 0.6
add rest_ms = 500

0ms..9000ms x=20 fz=0..1
9001ms..15000ms x=20 fz=1
15001ms x=20 fz=1.59
15002ms x=20 fz=1.61
15003ms x=20 fz=1.41
15004ms x=20 fz=1.39
15005ms x=20 fz=1.55
15006ms lift

15002ms ABS_HAT0X 1
15004ms ABS_HAT0X 0

case a hand that rests as a button is held taps nothing when it goes on resting
profile super-mario
add [access]
add rest_n = 0.5

0ms x=20 fz=2.5
100ms x=20 fz=0.3
600ms lift

0ms ABS_HAT0X 1
100ms ABS_HAT0X 0
100ms BTN_SOUTH 1
600ms BTN_SOUTH 0
