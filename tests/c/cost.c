/* What the interface costs beside the solver: getters, empty steps, saved states.
 *
 *     cc -O2 -std=c99 -Iinclude tests/c/cost.c -Ltarget/release -Wl,-rpath,$PWD/target/release -lsandgate_fmu -o cost
 *     ./cost tests/scenes/small_silo.toml cases/silo_gate.toml 1.35
 *
 * First scene: all gauges by one call; then steps of the scene at rest behind its closed gate, where the solver sleeps and
 * has next to nothing to do: such a step bounds from above what a step costs beyond the solver. Second scene, at a
 * resolution over its own: saving and restoring its state. Medians over repetitions, in wall time of a quiet machine.
 */
#define _POSIX_C_SOURCE 199309L

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "sandgate.h"

#define MOST 4096

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *times, size_t count)
{
    qsort(times, count, sizeof *times, ascending);
    return times[count / 2];
}

static void check(sandgate_instance *instance, int32_t status)
{
    if (status != 0) {
        fprintf(stderr, "%s\n", sandgate_last_error(instance));
        exit(1);
    }
}

static sandgate_instance *create(const char *path, double scale)
{
    char error[2000];
    uint32_t reference;
    sandgate_instance *instance = sandgate_create_from_file(path, error, sizeof error);
    if (instance == NULL) {
        fprintf(stderr, "%s\n", error);
        exit(1);
    }
    check(instance, sandgate_variable_by_name(instance, "solver.resolution_scale", &reference));
    check(instance, sandgate_set(instance, &reference, 1, &scale, 1));
    check(instance, sandgate_initialize(instance, 0.0, 1e9));
    return instance;
}

static void getters(sandgate_instance *instance)
{
    static double times[1000], values[MOST];
    static uint32_t references[MOST];
    size_t count = 0, length = 0, k, i;
    uint32_t r;
    for (r = 0; r < sandgate_variable_count(instance); r++) {
        sandgate_variable row;
        check(instance, sandgate_variable_info(instance, r, &row));
        if (row.causality == 3 && strncmp(row.name, "gauge.", 6) == 0 && count < MOST && length + row.length <= MOST) {
            references[count++] = r;
            length += (size_t)row.length;
        }
    }
    for (k = 0; k < 1000; k++) {
        double begin = now();
        for (i = 0; i < 100; i++) {
            check(instance, sandgate_get(instance, references, count, values, length));
        }
        times[k] = (now() - begin) / 100;
    }
    printf("all gauges by one call (%zu variables, %zu values): %.2f us\n", count, length, 1e6 * median(times, 1000));
}

static void steps(sandgate_instance *instance)
{
    static double times[2000];
    double t = 0.0, h = 1.0 / 128.0;
    size_t k;
    for (k = 0; k < 512; k++, t += h) {
        check(instance, sandgate_step(instance, t, h, NULL));
    }
    for (k = 0; k < 2000; k++, t += h) {
        double begin = now();
        check(instance, sandgate_step(instance, t, h, NULL));
        times[k] = now() - begin;
    }
    printf("a step of a sleeping scene: %.2f us\n", 1e6 * median(times, 2000));
}

static void states(sandgate_instance *instance)
{
    static double saves[101], restores[101];
    size_t size, written, k;
    double particles;
    uint32_t reference;
    uint8_t *bytes;
    check(instance, sandgate_step(instance, 0.0, 1e-3, NULL));
    check(instance, sandgate_variable_by_name(instance, "solver.particles", &reference));
    check(instance, sandgate_get(instance, &reference, 1, &particles, 1));
    check(instance, sandgate_save_size(instance, &size));
    bytes = malloc(size);
    for (k = 0; bytes != NULL && k < 101; k++) {
        double begin = now();
        check(instance, sandgate_save(instance, bytes, size, &written));
        saves[k] = now() - begin;
        begin = now();
        check(instance, sandgate_restore(instance, bytes, written));
        restores[k] = now() - begin;
    }
    free(bytes);
    printf("a state of %.0f particles, %zu bytes: save %.2f ms, restore %.2f ms\n", particles, size,
           1e3 * median(saves, 101), 1e3 * median(restores, 101));
}

int main(int argc, char **argv)
{
    sandgate_instance *instance;
    if (argc != 4) {
        fprintf(stderr, "cost RESTING_SCENE STATE_SCENE RESOLUTION_SCALE\n");
        return 2;
    }
    instance = create(argv[1], 1.0);
    getters(instance);
    steps(instance);
    sandgate_free(instance);
    instance = create(argv[2], atof(argv[3]));
    states(instance);
    sandgate_free(instance);
    return 0;
}
