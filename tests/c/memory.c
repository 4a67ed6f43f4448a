/*
 * A process that may take so many MB of address space: a scene that needs more is refused with a message, and the process
 * goes on.
 *
 *   memory SCENE MB
 */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>

#include "sandgate.h"

int main(int count, char **arguments) {
    char error[4000];
    struct rlimit room;
    sandgate_instance *instance;
    if (count != 3) {
        fprintf(stderr, "memory SCENE MB\n");
        return 2;
    }
    room.rlim_cur = room.rlim_max = (rlim_t)atol(arguments[2]) << 20;
    if (setrlimit(RLIMIT_AS, &room) != 0) {
        perror("setrlimit");
        return 1;
    }
    instance = sandgate_create_from_file(arguments[1], error, sizeof error);
    if (instance != NULL) {
        fprintf(stderr, "it found room\n");
        return 1;
    }
    printf("%s\n", error);
    return 0;
}
