/*
 * An importer with a floating-point environment of its own: traps, another rounding, no denormals. An FMU gives it the same
 * bits as in the default environment, with any number of threads; its own environment is as it was after every call, and
 * inside its callbacks. So does a thread with a small stack.
 *
 *   environment TOKEN THREADS RESOLUTION OPENING     value references of solver.threads and so on; linked with a packed library
 */
#define _GNU_SOURCE
#include <fenv.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef __x86_64__
#include <xmmintrin.h>
#endif

#include "fmi3Functions.h"

static const char *token;
static fmi3ValueReference threads_reference, resolution, opening;
static int logged, updated;

/* How this thread computes now, exception flags included. */
static unsigned control(void) {
#ifdef __x86_64__
    return _mm_getcsr();
#else
    return (unsigned)(fegetround() | fegetexcept() | fetestexcept(FE_ALL_EXCEPT));
#endif
}

static unsigned ours;

static void expect_ours(const char *where) {
    if (control() != ours) {
        fprintf(stderr, "%s: found control %x, expected %x\n", where, control(), ours);
        exit(1);
    }
}

static void check(fmi3Status status, const char *call) {
    expect_ours(call);
    if (status != fmi3OK) {
        fprintf(stderr, "%s: status %d\n", call, (int)status);
        exit(1);
    }
}

static void logger(fmi3InstanceEnvironment user, fmi3Status status, fmi3String category, fmi3String message) {
    (void)user;
    expect_ours("logger");
    logged += 1;
    if (status != fmi3OK) {
        fprintf(stderr, "%s: %s\n", category, message);
    }
}

static void update(fmi3InstanceEnvironment user, fmi3Float64 time, fmi3Boolean may_set, fmi3Boolean may_get,
                   fmi3Boolean accepted, fmi3Boolean may_return, fmi3Boolean *early, fmi3Float64 *early_time) {
    const fmi3ValueReference clock = 0;
    fmi3Float64 now = -1.0;
    (void)may_set, (void)may_get, (void)accepted, (void)may_return, (void)early, (void)early_time;
    expect_ours("intermediate update");
    check(fmi3GetFloat64(*(fmi3Instance *)user, &clock, 1, &now, 1), "fmi3GetFloat64 inside");
    if (memcmp(&now, &time, sizeof now) != 0) {
        fprintf(stderr, "another time inside\n");
        exit(1);
    }
    updated += 1;
}

struct bytes {
    size_t size;
    fmi3Byte *all;
};

/* A life of an instance in this environment; what it comes to. */
static struct bytes run(fmi3Int64 threads) {
    const double h = 1.0 / 256.0, half = 0.5, finer = 2.0;
    struct bytes saved = {0, NULL};
    fmi3Instance instance = NULL;
    fmi3FMUState state = NULL;
    int k;
    ours = control();
    instance = fmi3InstantiateCoSimulation("importer", token, NULL, fmi3False, fmi3True, fmi3False, fmi3False, &opening, 1,
                                           &instance, logger, update);
    expect_ours("fmi3InstantiateCoSimulation");
    if (instance == NULL) {
        fprintf(stderr, "no instance\n");
        exit(1);
    }
    check(fmi3SetFloat64(instance, &resolution, 1, &finer, 1), "fmi3SetFloat64");
    check(fmi3SetInt64(instance, &threads_reference, 1, &threads, 1), "fmi3SetInt64");
    check(fmi3EnterInitializationMode(instance, fmi3False, 0.0, 0.0, fmi3False, 0.0), "fmi3EnterInitializationMode");
    check(fmi3ExitInitializationMode(instance), "fmi3ExitInitializationMode");
    check(fmi3SetFloat64(instance, &opening, 1, &half, 1), "fmi3SetFloat64");
    for (k = 0; k < 4; ++k) {
        fmi3Boolean event, end, early;
        fmi3Float64 last;
        check(fmi3DoStep(instance, k * h, h, fmi3True, &event, &end, &early, &last), "fmi3DoStep");
    }
    check(fmi3GetFMUState(instance, &state), "fmi3GetFMUState");
    check(fmi3SerializedFMUStateSize(instance, state, &saved.size), "fmi3SerializedFMUStateSize");
    saved.all = malloc(saved.size);
    if (saved.all == NULL) {
        exit(1);
    }
    check(fmi3SerializeFMUState(instance, state, saved.all, saved.size), "fmi3SerializeFMUState");
    check(fmi3FreeFMUState(instance, &state), "fmi3FreeFMUState");
    fmi3FreeInstance(instance);
    expect_ours("fmi3FreeInstance");
    return saved;
}

static struct bytes usual;

static void compare(const char *where, fmi3Int64 threads) {
    struct bytes found = run(threads);
    if (found.size != usual.size || memcmp(found.all, usual.all, usual.size) != 0) {
        fprintf(stderr, "%s, %d threads: other bits\n", where, (int)threads);
        exit(1);
    }
    free(found.all);
}

static void *with_little_stack(void *unused) {
    compare("a stack of 128 KiB", 1);
    compare("a stack of 128 KiB", 2);
    return unused;
}

/* An embedded scene takes 256 KiB: a copy of it on this stack ends the process. */
static void run_on_a_small_stack(void) {
    pthread_attr_t small;
    pthread_t thread;
    if (pthread_attr_init(&small) != 0 || pthread_attr_setstacksize(&small, 128 * 1024) != 0
        || pthread_create(&thread, &small, with_little_stack, NULL) != 0) {
        fprintf(stderr, "no thread\n");
        exit(1);
    }
    pthread_join(thread, NULL);
}

int main(int argc, char **argv) {
    fmi3Int64 threads;
    if (argc != 5) {
        fprintf(stderr, "usage: environment TOKEN THREADS RESOLUTION OPENING\n");
        return 2;
    }
    token = argv[1];
    threads_reference = (fmi3ValueReference)atoi(argv[2]);
    resolution = (fmi3ValueReference)atoi(argv[3]);
    opening = (fmi3ValueReference)atoi(argv[4]);
    usual = run(1);
    for (threads = 1; threads <= 2; ++threads) {
        compare("default", threads);
        fesetround(FE_UPWARD);
        compare("rounding upward", threads);
        fesetround(FE_TONEAREST);
        feclearexcept(FE_ALL_EXCEPT);
        feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
        compare("traps", threads);
        fedisableexcept(FE_ALL_EXCEPT);
#ifdef __x86_64__
        _mm_setcsr(_mm_getcsr() | 0x8040);
        compare("denormals as zero", threads);
        _mm_setcsr(_mm_getcsr() & ~0x8040u);
#endif
    }
    run_on_a_small_stack();
    if (logged == 0 || updated == 0) {
        fprintf(stderr, "%d messages, %d updates\n", logged, updated);
        return 1;
    }
    printf("%d messages, %d updates, %zu bytes\n", logged, updated, usual.size);
    free(usual.all);
    return 0;
}
