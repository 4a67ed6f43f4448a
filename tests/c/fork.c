/*
 * A process that forks with an instance of two threads and a log: the child steps with threads of its own and gets the same
 * bits, whatever it does first; its parent goes on, and the log is the parent's.
 *
 *   fork SCENE LOG
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "sandgate.h"

static const double h = 1.0 / 256.0;

static void check(sandgate_instance *silo, int32_t status, const char *what) {
    if (status != SANDGATE_OK) {
        fprintf(stderr, "%s: status %d: %s\n", what, (int)status, sandgate_last_error(silo));
        exit(1);
    }
}

static uint32_t find(sandgate_instance *silo, const char *name) {
    uint32_t reference = 0;
    check(silo, sandgate_variable_by_name(silo, name, &reference), name);
    return reference;
}

/* Twice as fine as the scene, so that sweeps are long enough for threads. */
static sandgate_instance *begun(const char *scene, uint32_t threads, const char *log) {
    char error[1000];
    const double finer = 2.0;
    uint32_t scale;
    sandgate_instance *silo = sandgate_create_from_file(scene, error, sizeof error);
    if (silo == NULL) {
        fprintf(stderr, "%s\n", error);
        exit(1);
    }
    scale = find(silo, "solver.resolution_scale");
    check(silo, sandgate_set_threads(silo, threads), "set_threads");
    check(silo, sandgate_set(silo, &scale, 1, &finer, 1), "set");
    if (log != NULL) {
        check(silo, sandgate_set_text(silo, find(silo, "log.path"), log), "set_text");
    }
    check(silo, sandgate_initialize(silo, 0.0, INFINITY), "initialize");
    check(silo, sandgate_step(silo, 0.0, h, NULL), "first step");
    return silo;
}

struct bytes {
    size_t size;
    uint8_t *all;
};

static struct bytes saved(sandgate_instance *silo) {
    struct bytes state;
    check(silo, sandgate_save_size(silo, &state.size), "save_size");
    state.all = malloc(state.size);
    check(silo, sandgate_save(silo, state.all, state.size, &state.size), "save");
    return state;
}

/* The second step, and what it must come to. */
static void step(sandgate_instance *silo, const struct bytes *wanted) {
    struct bytes found;
    check(silo, sandgate_step(silo, h, h, NULL), "second step");
    found = saved(silo);
    if (found.size != wanted->size || memcmp(found.all, wanted->all, wanted->size) != 0) {
        fprintf(stderr, "other bits after the fork\n");
        exit(1);
    }
    free(found.all);
}

/* A child that does something first; a signal ends one that waits for threads that are not there. */
static void in_a_child(sandgate_instance *silo, int way, const struct bytes *first, const struct bytes *second) {
    int status;
    const pid_t child = fork();
    if (child == 0) {
        alarm(120);
        switch (way) {
        case 0:
            break;
        case 1:
            check(silo, sandgate_set_threads(silo, 3), "set_threads in a child");
            break;
        case 2:
            check(silo, sandgate_restore(silo, first->all, first->size), "restore in a child");
            break;
        default:
            check(silo, sandgate_reset(silo), "reset in a child");
            check(silo, sandgate_restore(silo, first->all, first->size), "restore after a reset in a child");
        }
        step(silo, second);
        sandgate_free(silo);
        _exit(0);
    }
    if (child < 0 || waitpid(child, &status, 0) != child || status != 0) {
        fprintf(stderr, "way %d: the child ended with status %x\n", way, (unsigned)status);
        exit(1);
    }
}

/* A child has no part in the log that its parent writes. */
static void with_a_log(const char *scene, const char *log, const struct bytes *second) {
    int status;
    sandgate_instance *silo = begun(scene, 2, log);
    const pid_t child = fork();
    if (child == 0) {
        alarm(120);
        if (sandgate_step(silo, h, h, NULL) != SANDGATE_OUTSIDE || strstr(sandgate_last_error(silo), "forked") == NULL) {
            fprintf(stderr, "a step of a child with a log: %s\n", sandgate_last_error(silo));
            _exit(1);
        }
        sandgate_free(silo);
        _exit(0);
    }
    if (child < 0 || waitpid(child, &status, 0) != child || status != 0) {
        fprintf(stderr, "the child with a log ended with status %x\n", (unsigned)status);
        exit(1);
    }
    step(silo, second);
    check(silo, sandgate_terminate(silo), "terminate");
    sandgate_free(silo);
}

int main(int count, char **arguments) {
    struct bytes first, second;
    sandgate_instance *alone, *silo;
    int way;
    if (count != 3) {
        fprintf(stderr, "fork SCENE LOG\n");
        return 2;
    }
    alone = begun(arguments[1], 1, NULL);
    first = saved(alone);
    check(alone, sandgate_step(alone, h, h, NULL), "second step");
    second = saved(alone);
    sandgate_free(alone);
    silo = begun(arguments[1], 2, NULL);
    for (way = 0; way < 4; ++way) {
        in_a_child(silo, way, &first, &second);
    }
    step(silo, &second);
    sandgate_free(silo);
    with_a_log(arguments[1], arguments[2], &second);
    free(first.all);
    free(second.all);
    return 0;
}
