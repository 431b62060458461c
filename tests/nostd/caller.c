/* Calls the crate's entry points as a firmware does. Prints a sample's frame and what the crate makes of the bytes
 * of a set rate command, cut off once and then whole. */
#include <stdio.h>
#include <stdlib.h>

#include "tactpad_proto.h"

size_t tactpad_crate_receiver_len(void);
void tactpad_crate_receiver_reset(void *receiver);
enum tactpad_event tactpad_crate_receive(void *receiver, uint8_t byte, struct tactpad_command *command);

int main(void)
{
    static const uint8_t bytes[] = {9, 1, 0, 0x09, 0x01, 0x82, 0xe8, 0x03, 0xc9, 0x5f, 0xe7, 0x74, 0x00};
    const struct tactpad_sample sample = {
        1000, 12345678, {152, -1203, 20480, -77, 64, 18250, 256, -1, 16384}, 2315, 0,
    };
    uint8_t frame[TACTPAD_ENCODED_MAX];
    struct tactpad_command command = {0, 0};
    void *receiver = malloc(tactpad_crate_receiver_len());
    size_t len = tactpad_encode_sample(&sample, frame);
    for (size_t i = 0; i < len; i++)
        printf("%02x ", frame[i]);
    if (!receiver)
        return EXIT_FAILURE;
    tactpad_crate_receiver_reset(receiver);
    for (size_t i = 0; i < sizeof bytes; i++) {
        enum tactpad_event event = tactpad_crate_receive(receiver, bytes[i], &command);
        if (event != TACTPAD_NOTHING)
            printf("\n%d %02x %u", (int)event, command.kind, command.value);
    }
    free(receiver);
    return EXIT_SUCCESS;
}
