# Presses that ask something of the bridge.

case a press asks once, where it begins
profile one-button
output keyboard
remove button.1
add [[button]]
add force = "fz"
add press_n = 2
add out = { bridge = "panic" }

0ms fz=2.5
79ms fz=2.5
80ms fz=2.5
90ms..200ms fz=2.5
300ms lift

80ms bridge panic

case a long press asks when it becomes long, a short one when it ends
profile super-mario
remove button.1
add [[button]]
add force = "fz"
add press_n = 2
add tap = { bridge = "pause" }
add hold = { bridge = "next-profile" }

0ms fz=2.5
399ms fz=2.5
400ms fz=2.5
500ms lift
600ms fz=2.5
700ms lift

400ms bridge next-profile
700ms bridge pause

case a profile is asked for by its name
profile super-mario
remove button.1
add [[button]]
add force = "fz"
add press_n = 2
add tap = { bridge = "profile my game" }
add double = { bridge = "tare" }

0ms fz=2.5
10ms lift
260ms lift
500ms fz=2.5
510ms lift
520ms fz=2.5
530ms lift

260ms bridge profile my game
520ms bridge tare
