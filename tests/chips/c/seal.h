#include <stddef.h>
#include <stdint.h>

/* Puts the check sum at the end of a snapshot right: CRC-32, its lowest byte first. */
static void seal(uint8_t *bytes, size_t count) {
    uint32_t sum = 0xffffffff;
    for (size_t i = 0; i < count - 4; i++) {
        sum ^= bytes[i];
        for (int bit = 0; bit < 8; bit++) sum = sum >> 1 ^ (sum & 1 ? 0xedb88320 : 0);
    }
    for (int i = 0; i < 4; i++) bytes[count - 4 + i] = (uint8_t)(~sum >> 8 * i);
}
