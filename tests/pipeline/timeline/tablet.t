# [pointer] in mode "absolute": the plate is the screen.

case the pointer is where the finger is
profile super-mario
set dpad.min_force_n = 20
remove button.1
add [pointer]
add mode = "absolute"

0ms x=0 y=0 fz=1
1ms x=24 y=0 fz=1
2ms x=-24 y=24 fz=1
3ms x=-30 y=12 fz=1

0ms ABS_X 16384
0ms ABS_Y 16384
1ms ABS_X 32767
2ms ABS_X 1
2ms ABS_Y 1
3ms ABS_Y 8193
