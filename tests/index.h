/* The names of the public functions of mcsample.h, from the prototypes between the two lines below. */
#ifndef MCST_INDEX_H
#define MCST_INDEX_H
#include <stdio.h>
#include <string.h>

#ifndef MCS_HEADER
#define MCS_HEADER "mcsample.h" /* its path from where the test is run */
#endif
#define MCST_INTERFACE "PART I: THE INTERFACE"
#define MCST_INTERFACE_END "END OF PART I"

enum { MCST_NAMES = 512, MCST_NAME = 48 };
static char mcst_name[MCST_NAMES][MCST_NAME];
static int mcst_name_count;

static inline int mcst_is_word(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/* -1 where the name is not in the list. */
static inline int mcst_name_at(const char *name, char (*list)[MCST_NAME], int count) {
    int i;
    for (i = 0; i < count && strcmp(list[i], name) != 0; i++) continue;
    return i < count ? i : -1;
}

static inline void mcst_add_name(const char *at, size_t length) {
    if (length >= MCST_NAME || mcst_name_count == MCST_NAMES) return;
    memcpy(mcst_name[mcst_name_count], at, length);
    mcst_name[mcst_name_count][length] = 0;
    mcst_name_count++;
}

/* A prototype starts a line with MCS_FN or MCS_API; its name is the first word that starts with mcs_ and has a
 * parenthesis after it. */
static inline void mcst_read_prototypes(const char *from, const char *end) {
    const char *at = from;
    while ((at = strstr(at, "\nMCS_")) != NULL && at < end) {
        size_t length = 0;
        at += strlen("\n");
        if (strncmp(at, "MCS_FN ", 7) != 0 && strncmp(at, "MCS_API ", 8) != 0) continue;
        while (*at && *at != ';' && *at != '{') {
            for (length = 0; mcst_is_word(at[length]);) length++;
            if (length > 4 && !strncmp(at, "mcs_", 4) && at[length] == '(') break;
            at += length ? length : 1;
        }
        if (!strncmp(at, "mcs_lanes(", strlen("mcs_lanes("))) continue; /* it tells of the processor; hygiene asks it */
        if (*at && *at != ';' && *at != '{') mcst_add_name(at, length);
    }
}

/* Fills mcst_name; 0 when the header cannot be read whole, or has no such lines. */
static inline int mcst_read_names(void) {
    static char header[1 << 20];
    FILE *f = fopen(MCS_HEADER, "rb");
    const char *from, *end;
    size_t length;
    if (!f) return 0;
    length = fread(header, 1, sizeof header - 1, f);
    fclose(f);
    header[length] = 0;
    from = strstr(header, MCST_INTERFACE);
    end = strstr(header, MCST_INTERFACE_END);
    if (!from || !end) return 0;
    mcst_read_prototypes(from, end);
    return length < sizeof header - 1;
}
#endif
