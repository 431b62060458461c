/* Lets a test of the Rust crate call the C code: one call per line on standard input, its result on standard
 * output, bytes as hex.
 *
 *   sample SEQUENCE TIME_US COUNT x 9 TEMPERATURE STATUS     frame and report
 *   channels SEQUENCE TIME_US N TEMPERATURE STATUS COUNT x N frame and report
 *   contact SEQUENCE TIME_US X Y FX FY FZ DEVIATION x 3 TOUCHED SHEAR STATUS   frame and report
 *   identity =SERIAL CHANNELS BITS RATE PICOVOLTS            frame and report
 *   acknowledgement KIND RESULT                              frame and report
 *   bytes HEX                                                what each byte meant to one receiver, if anything
 *   report HEX                                               what the report meant
 *   descriptor                                               the report descriptor
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tactpad_proto.h"

enum { LINE_MAX_LEN = 1 << 20 };

static char line[LINE_MAX_LEN];
static uint8_t bytes[LINE_MAX_LEN / 2];

static void print_hex(const uint8_t *from, size_t len)
{
    for (size_t i = 0; i < len; i++)
        printf("%02x", from[i]);
}

static void print_message(const uint8_t *frame, size_t len, const uint8_t *report)
{
    print_hex(frame, len);
    putchar(' ');
    print_hex(report, TACTPAD_REPORT_LEN);
    putchar('\n');
}

static void print_event(enum tactpad_event event, const struct tactpad_command *command)
{
    static const char *const names[] = {"", "command", "damaged", "too_long", "unknown_kind", "newer_version"};
    if (event == TACTPAD_COMMAND)
        printf("%s:%02x:%u ", names[event], command->kind, command->value);
    else if (event == TACTPAD_UNKNOWN_KIND)
        printf("%s:%02x ", names[event], command->kind);
    else if (event != TACTPAD_NOTHING)
        printf("%s ", names[event]);
}

static size_t parse_hex(const char *text)
{
    size_t len = 0;
    unsigned byte;
    while (sscanf(text + 2 * len, "%2x", &byte) == 1)
        bytes[len++] = (uint8_t)byte;
    return len;
}

static void call_sample(const char *rest)
{
    struct tactpad_sample sample;
    uint8_t frame[TACTPAD_ENCODED_MAX], report[TACTPAD_REPORT_LEN];
    int used;
    sscanf(rest, "%" SCNu32 "%" SCNu64 "%n", &sample.sequence, &sample.time_us, &used);
    for (int channel = 0; channel < TACTPAD_CHANNELS; channel++) {
        rest += used;
        sscanf(rest, "%" SCNd32 "%n", &sample.counts[channel], &used);
    }
    sscanf(rest + used, "%" SCNd16 "%" SCNu16, &sample.temperature_centi_c, &sample.status);
    tactpad_report_sample(&sample, report);
    print_message(frame, tactpad_encode_sample(&sample, frame), report);
}

static void call_channels(const char *rest)
{
    struct tactpad_channels sample;
    uint8_t frame[TACTPAD_ENCODED_MAX], report[TACTPAD_REPORT_LEN];
    int used;
    sscanf(rest, "%" SCNu32 "%" SCNu64 "%" SCNu8 "%" SCNd16 "%" SCNu16 "%n", &sample.sequence, &sample.time_us,
           &sample.channels, &sample.temperature_centi_c, &sample.status, &used);
    for (int channel = 0; channel < sample.channels; channel++) {
        rest += used;
        sscanf(rest, "%" SCNd32 "%n", &sample.counts[channel], &used);
    }
    tactpad_report_channels(&sample, report);
    print_message(frame, tactpad_encode_channels(&sample, frame), report);
}

static void call_contact(const char *rest)
{
    struct tactpad_contact sample;
    unsigned touched, shear;
    uint8_t frame[TACTPAD_ENCODED_MAX], report[TACTPAD_REPORT_LEN];
    sscanf(rest,
           "%" SCNu32 "%" SCNu64 "%" SCNd32 "%" SCNd32 "%" SCNd32 "%" SCNd32 "%" SCNd32 "%" SCNu16 "%" SCNu16
           "%" SCNu16 "%u%u%" SCNu16,
           &sample.sequence, &sample.time_us, &sample.place_um[0], &sample.place_um[1], &sample.force_mn[0],
           &sample.force_mn[1], &sample.force_mn[2], &sample.place_deviation_um, &sample.shear_deviation_mn,
           &sample.normal_deviation_mn, &touched, &shear, &sample.status);
    sample.is_touched = touched != 0;
    sample.has_shear = shear != 0;
    tactpad_report_contact(&sample, report);
    print_message(frame, tactpad_encode_contact(&sample, frame), report);
}

static void call_identity(const char *rest)
{
    struct tactpad_identity identity;
    char serial_number[TACTPAD_SERIAL_NUMBER_LEN + 2] = {0};
    uint8_t frame[TACTPAD_ENCODED_MAX], report[TACTPAD_REPORT_LEN];
    /* What a serial number does not fill must not reach the wire. */
    memset(&identity, 0xAA, sizeof identity);
    sscanf(rest, "%17s%" SCNu8 "%" SCNu8 "%" SCNu16 "%" SCNu32, serial_number, &identity.channels,
           &identity.count_bits, &identity.rate_hz, &identity.picovolts_per_count);
    for (int i = 0; i < TACTPAD_SERIAL_NUMBER_LEN; i++) {
        identity.serial_number[i] = serial_number[i + 1];
        if (serial_number[i + 1] == 0)
            break;
    }
    tactpad_report_identity(&identity, report);
    print_message(frame, tactpad_encode_identity(&identity, frame), report);
}

static void call_acknowledgement(const char *rest)
{
    uint8_t kind;
    unsigned result;
    uint8_t frame[TACTPAD_ENCODED_MAX], report[TACTPAD_REPORT_LEN];
    sscanf(rest, "%" SCNu8 "%u", &kind, &result);
    tactpad_report_acknowledgement(kind, (enum tactpad_result)result, report);
    print_message(frame, tactpad_encode_acknowledgement(kind, (enum tactpad_result)result, frame), report);
}

int main(void)
{
    struct tactpad_receiver receiver;
    struct tactpad_command command = {0, 0};
    tactpad_receiver_reset(&receiver);
    while (fgets(line, sizeof line, stdin)) {
        char word[16];
        int used;
        if (sscanf(line, "%15s %n", word, &used) != 1)
            return EXIT_FAILURE;
        const char *rest = line + used;
        if (strcmp(word, "sample") == 0) {
            call_sample(rest);
        } else if (strcmp(word, "channels") == 0) {
            call_channels(rest);
        } else if (strcmp(word, "contact") == 0) {
            call_contact(rest);
        } else if (strcmp(word, "identity") == 0) {
            call_identity(rest);
        } else if (strcmp(word, "acknowledgement") == 0) {
            call_acknowledgement(rest);
        } else if (strcmp(word, "bytes") == 0) {
            size_t len = parse_hex(rest);
            for (size_t i = 0; i < len; i++)
                print_event(tactpad_receive(&receiver, bytes[i], &command), &command);
            putchar('\n');
        } else if (strcmp(word, "report") == 0) {
            print_event(tactpad_decode_report(bytes, parse_hex(rest), &command), &command);
            putchar('\n');
        } else if (strcmp(word, "descriptor") == 0) {
            print_hex(tactpad_report_descriptor, sizeof tactpad_report_descriptor);
            putchar('\n');
        } else {
            return EXIT_FAILURE;
        }
    }
    return EXIT_SUCCESS;
}
