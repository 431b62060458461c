/* A board made of a POSIX system: the same firmware runs on a PC, behind a pseudo-terminal.
 *
 * Build: gcc -O2 -I.. host_board.c pad_firmware.c ../tactpad_proto.c -o host_pad
 *
 * Its argument is the rate in hertz; 1000 without one. The first line it prints is the path to open as a serial port. The board starts when that port is first
 * opened, as a pad does that draws its power from there. It says when its light goes on and off, and at the
 * end, by SIGTERM or SIGINT, its counts.
 */
#define _XOPEN_SOURCE 700

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include "board.h"
#include "pad_firmware.h"

enum {
    /* The converter: 24 bits, 0.01 uV per count at the bridge. */
    COUNT_BITS = 24,
    PICOVOLTS_PER_COUNT = 10000,
    COUNTS_PER_UV = 100,
    NOISE_COUNTS = 600,
    REST_MS = 1000,
    /* A press: the finger comes down, stays and leaves, then the pad rests. */
    RAMP_MS = 20,
    PRESS_MS = 300,
    PERIOD_MS = 500
};

/* What the nominal pad reads of each press in turn, in uV: 1.5 N on each post, 1.6 N between them, 3 N in the middle. */
static const int16_t presses_uv[][TACTPAD_CHANNELS] = {
    {0, -673, 2833, -21, 336, 7, 21, 336, 7},
    {21, 336, 7, 0, -673, 2833, -21, 336, 7},
    {-21, 336, 7, 21, 336, 7, 0, -673, 2833},
    {-30, -105, 1513, 30, -105, 1513, 0, 474, 11},
    {0, 474, 11, -30, -105, 1513, 30, -105, 1513},
    {30, -105, 1513, 0, 474, 11, -30, -105, 1513},
    {0, 206, 1899, 0, 206, 1899, 0, 206, 1899},
};

static uint16_t rate_hz = 1000;
static int terminal;
static uint64_t started_us;
static volatile sig_atomic_t ended;

static uint64_t monotonic_us(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000 + (uint64_t)now.tv_nsec / 1000;
}

void board_identity(struct tactpad_identity *identity)
{
    static const char serial_number[TACTPAD_SERIAL_NUMBER_LEN] = "HOST-0001";
    memcpy(identity->serial_number, serial_number, sizeof serial_number);
    identity->count_bits = COUNT_BITS;
    identity->rate_hz = rate_hz;
    identity->picovolts_per_count = PICOVOLTS_PER_COUNT;
}

uint64_t board_time_us(void)
{
    return monotonic_us() - started_us;
}

void board_wait_until(uint64_t deadline_us)
{
    uint64_t at_us = started_us + deadline_us;
    struct timespec at = {.tv_sec = (time_t)(at_us / 1000000), .tv_nsec = (long)(at_us % 1000000) * 1000};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, NULL);
}

/* Parts in RAMP_MS of the present press that bear on the pad. */
static int32_t weight(uint64_t in_period_ms)
{
    if (in_period_ms < RAMP_MS)
        return (int32_t)in_period_ms;
    if (in_period_ms < PRESS_MS - RAMP_MS)
        return RAMP_MS;
    return in_period_ms < PRESS_MS ? (int32_t)(PRESS_MS - in_period_ms) : 0;
}

/* Uniform within NOISE_COUNTS either way. */
static int32_t noise_counts(void)
{
    static uint32_t state = 1;
    state = state * 1664525 + 1013904223;
    return (int32_t)((state >> 8) % (2 * NOISE_COUNTS + 1)) - NOISE_COUNTS;
}

void board_adc_read(int32_t counts[TACTPAD_CHANNELS], int16_t *temperature_centi_c, uint16_t *status)
{
    uint64_t now_ms = board_time_us() / 1000;
    for (int channel = 0; channel < TACTPAD_CHANNELS; channel++)
        counts[channel] = noise_counts();
    if (now_ms >= REST_MS) {
        uint64_t period = (now_ms - REST_MS) / PERIOD_MS;
        const int16_t *uv = presses_uv[period % (sizeof presses_uv / sizeof *presses_uv)];
        int32_t parts = weight((now_ms - REST_MS) % PERIOD_MS);
        for (int channel = 0; channel < TACTPAD_CHANNELS; channel++)
            counts[channel] += uv[channel] * COUNTS_PER_UV / RAMP_MS * parts;
    }
    *temperature_centi_c = 2500;
    *status = 0;
}

static bool somebody_listens(void)
{
    struct pollfd fd = {.fd = terminal, .events = 0};
    return poll(&fd, 1, 0) >= 0 && !(fd.revents & POLLHUP);
}

/* A port that no program has open takes everything, as a wire to nowhere does. */
size_t board_link_write(const uint8_t *bytes, size_t len)
{
    if (len == 0 || !somebody_listens())
        return len;
    ssize_t taken = write(terminal, bytes, len);
    return taken > 0 ? (size_t)taken : 0;
}

size_t board_link_read(uint8_t *bytes, size_t len)
{
    ssize_t taken = read(terminal, bytes, len);
    return taken > 0 ? (size_t)taken : 0;
}

void board_light(bool on)
{
    puts(on ? "light on" : "light off");
    fflush(stdout);
}

static void end(int signal)
{
    (void)signal;
    ended = 1;
}

static void fail(const char *what)
{
    perror(what);
    exit(EXIT_FAILURE);
}

/* Opens a terminal in raw mode: it must neither echo bytes nor rewrite them. The mode stays when the far end, which
 * sets it, is closed again; and only a terminal that was open once can tell that nobody has it open. */
static const char *open_terminal(void)
{
    struct termios mode;
    terminal = posix_openpt(O_RDWR | O_NOCTTY);
    if (terminal < 0 || grantpt(terminal) < 0 || unlockpt(terminal) < 0)
        fail("posix_openpt");
    if (fcntl(terminal, F_SETFL, O_NONBLOCK) < 0)
        fail("fcntl");
    const char *path = ptsname(terminal);
    int far_end = open(path, O_RDWR | O_NOCTTY);
    if (far_end < 0 || tcgetattr(far_end, &mode) < 0)
        fail(path);
    mode.c_iflag = 0;
    mode.c_oflag = 0;
    mode.c_lflag = 0;
    mode.c_cflag = (mode.c_cflag & ~(tcflag_t)(CSIZE | PARENB)) | CS8;
    if (tcsetattr(far_end, TCSANOW, &mode) < 0)
        fail("tcsetattr");
    close(far_end);
    return path;
}

int main(int argc, char **argv)
{
    static struct pad pad;
    if (argc > 1)
        rate_hz = (uint16_t)strtoul(argv[1], NULL, 10);
    if (rate_hz < TACTPAD_RATE_MIN_HZ || rate_hz > TACTPAD_RATE_MAX_HZ) {
        fprintf(stderr, "usage: %s [RATE_HZ, %d to %d]\n", argv[0], TACTPAD_RATE_MIN_HZ, TACTPAD_RATE_MAX_HZ);
        return EXIT_FAILURE;
    }
    struct sigaction action = {.sa_handler = end};
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGINT, &action, NULL);
    puts(open_terminal());
    fflush(stdout);
    while (!ended && !somebody_listens())
        board_wait_until(board_time_us() + 1000);
    started_us = monotonic_us();
    pad_start(&pad);
    while (!ended)
        pad_step(&pad);
    printf("samples %" PRIu32 ", bytes not taken %" PRIu32 ", stalls %" PRIu32 "\n", pad.sequence,
           pad.bytes_not_taken, pad.stalls);
    return EXIT_SUCCESS;
}
