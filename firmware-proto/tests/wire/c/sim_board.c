/* A board on which the reference firmware's time is simulated, so that a test knows to the microsecond what must
 * come. The first argument is the rate at the start. Calls are lines on standard input:
 *
 *   receive HEX     the host sends these bytes
 *   room BYTES      the link takes so many bytes more, and then none
 *   stall US        the board does nothing for so long
 *   run US          the firmware runs until this time; prints the bytes that the link took as hex, what the
 *                   light did and when, and the firmware's counts
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "board.h"
#include "pad_firmware.h"

enum { LINE_MAX_LEN = 1 << 16, CONVERSION_US = 20 };

static uint16_t first_rate_hz;
static uint64_t now_us;
static uint32_t room = UINT32_MAX;
static uint32_t conversions;
static uint8_t from_host[LINE_MAX_LEN];
static size_t from_host_len;
static size_t from_host_read;

void board_identity(struct tactpad_identity *identity)
{
    memset(identity, 0, sizeof *identity);
    memcpy(identity->serial_number, "SIM-0001", 8);
    identity->count_bits = 24;
    identity->rate_hz = first_rate_hz;
    identity->picovolts_per_count = 2384;
}

uint64_t board_time_us(void)
{
    return now_us;
}

void board_wait_until(uint64_t deadline_us)
{
    if (now_us < deadline_us)
        now_us = deadline_us;
}

void board_adc_read(int32_t counts[TACTPAD_CHANNELS], int16_t *temperature_centi_c, uint16_t *status)
{
    for (int channel = 0; channel < TACTPAD_CHANNELS; channel++)
        counts[channel] = (int32_t)conversions * 16 - channel;
    conversions++;
    now_us += CONVERSION_US;
    *temperature_centi_c = -123;
    *status = 1 << 4;
}

size_t board_link_write(const uint8_t *bytes, size_t len)
{
    size_t taken = len < room ? len : room;
    for (size_t i = 0; i < taken; i++)
        printf("%02x", bytes[i]);
    if (room != UINT32_MAX)
        room -= (uint32_t)taken;
    return taken;
}

size_t board_link_read(uint8_t *bytes, size_t len)
{
    size_t there = from_host_len - from_host_read;
    size_t taken = len < there ? len : there;
    memcpy(bytes, from_host + from_host_read, taken);
    from_host_read += taken;
    return taken;
}

void board_light(bool on)
{
    printf(" %s@%" PRIu64 " ", on ? "on" : "off", now_us);
}

static void receive(const char *text)
{
    unsigned byte;
    from_host_len = 0;
    from_host_read = 0;
    while (sscanf(text + 2 * from_host_len, "%2x", &byte) == 1)
        from_host[from_host_len++] = (uint8_t)byte;
}

int main(int argc, char **argv)
{
    static char line[LINE_MAX_LEN];
    static struct pad pad;
    first_rate_hz = (uint16_t)(argc > 1 ? atoi(argv[1]) : 1000);
    /* What the memory holds at the start must not matter. */
    memset(&pad, 0xAA, sizeof pad);
    pad_start(&pad);
    while (fgets(line, sizeof line, stdin)) {
        char word[16];
        int used;
        if (sscanf(line, "%15s %n", word, &used) != 1)
            return EXIT_FAILURE;
        if (strcmp(word, "receive") == 0) {
            receive(line + used);
        } else if (strcmp(word, "room") == 0) {
            room = (uint32_t)strtoul(line + used, NULL, 10);
        } else if (strcmp(word, "stall") == 0) {
            now_us += strtoull(line + used, NULL, 10);
        } else if (strcmp(word, "run") == 0) {
            uint64_t until_us = strtoull(line + used, NULL, 10);
            while (pad.due_us < until_us)
                pad_step(&pad);
            printf(" not_taken=%" PRIu32 " stalls=%" PRIu32 "\n", pad.bytes_not_taken, pad.stalls);
        } else {
            return EXIT_FAILURE;
        }
    }
    return EXIT_SUCCESS;
}
