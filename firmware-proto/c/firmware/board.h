/* What a board gives to the firmware. None of these may wait, except board_wait_until. */
#ifndef TACTPAD_BOARD_H
#define TACTPAD_BOARD_H

#include "tactpad_proto.h"

/* The serial number, the bits of a count, its picovolts and the first sample rate, from wherever the board
 * keeps them. Asked once, at the start. */
void board_identity(struct tactpad_identity *identity);

/* Microseconds since the board was started. It never goes back. */
uint64_t board_time_us(void);

/* Returns at deadline_us, or before: on any interrupt, or at once where there is nothing to save. */
void board_wait_until(uint64_t deadline_us);

/* The newest conversion of all nine channels, sign-extended, and the board's temperature. Sets the status
 * bits that the board can tell and leaves the others zero. */
void board_adc_read(int32_t counts[TACTPAD_CHANNELS], int16_t *temperature_centi_c, uint16_t *status);

/* Hands bytes to the link; returns how many of the first of them it took. */
size_t board_link_write(const uint8_t *bytes, size_t len);

/* Takes what came over the link, at most len bytes; returns how many. */
size_t board_link_read(uint8_t *bytes, size_t len);

/* The light by which a player finds the pad. */
void board_light(bool on);

#endif
