/*
 * Empties a silo step by step from C: reads its table of variables, opens the gate, prints the level, saves, tries what
 * a half-shut gate would do, and goes back.
 *
 *   cargo build --release -p sandgate-fmu
 *   cc -std=c99 -Iinclude examples/c/silo.c -Ltarget/release -lsandgate_fmu -lm -Wl,-rpath,$PWD/target/release -o silo
 *   ./silo tests/scenes/small_silo.toml
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "sandgate.h"

/* Ends the program with the library's own words if a call was refused. */
static void check(const sandgate_instance *silo, int32_t status) {
    if (status != SANDGATE_OK) {
        fprintf(stderr, "status %d: %s\n", (int)status, sandgate_last_error(silo));
        exit(1);
    }
}

static void complain(void *user, const char *category, const char *message) {
    fprintf((FILE *)user, "%s: %s\n", category, message);
}

/* Prints inputs and outputs with their units. */
static void print_table(const sandgate_instance *silo) {
    const uint32_t count = sandgate_variable_count(silo);
    uint32_t reference;
    for (reference = 0; reference < count; ++reference) {
        sandgate_variable row;
        check(silo, sandgate_variable_info(silo, reference, &row));
        if (row.causality == SANDGATE_INPUT || row.causality == SANDGATE_OUTPUT) {
            printf("%4u %-6s %-28s %-6s %s\n", (unsigned)row.reference,
                   row.causality == SANDGATE_INPUT ? "input" : "output", row.name, row.unit, row.description);
        }
    }
}

/* Steps to `until` with the gate open by `opening`; prints the level, and gives it. */
static double run(sandgate_instance *silo, double opening, double until) {
    const double h = 0.01;
    uint32_t gate = 0, outputs[2] = {0, 0};
    double time = 0.0, values[2] = {0.0, 0.0};
    check(silo, sandgate_variable_by_name(silo, "gate.main.opening", &gate));
    check(silo, sandgate_variable_by_name(silo, "gauge.level.depth", &outputs[0]));
    check(silo, sandgate_variable_by_name(silo, "mass.present", &outputs[1]));
    check(silo, sandgate_set(silo, &gate, 1, &opening, 1));
    check(silo, sandgate_time(silo, &time));
    while (time < until - 0.5 * h) {
        sandgate_step_report report;
        check(silo, sandgate_step(silo, time, h, &report));
        check(silo, sandgate_get(silo, outputs, 2, values, 2));
        time = report.time; /* time + h, bit for bit */
        printf("t %.2f s  level %5.1f mm  mass %.3f kg  (%u internal steps)\n", time, 1000.0 * values[0], values[1],
               (unsigned)report.substeps);
    }
    return values[0];
}

int main(int argc, char **argv) {
    char error[4096];
    sandgate_instance *silo;
    uint8_t *state;
    size_t size = 0;
    double wide, narrow, again;

    if (argc != 2 || sandgate_abi_version() != SANDGATE_ABI_VERSION) {
        fprintf(stderr, "usage: silo SCENE, with the library that belongs to the header\n");
        return 2;
    }
    silo = sandgate_create_from_file(argv[1], error, sizeof error);
    if (silo == NULL) {
        fprintf(stderr, "%s\n", error);
        return 1;
    }
    printf("Sandgate %s, %s\n", sandgate_version(), argv[1]);
    print_table(silo);
    check(silo, sandgate_initialize(silo, 0.0, INFINITY));
    run(silo, 1.0, 0.05);

    /* The state is ours: bytes that we may write to a file or send to another process. */
    check(silo, sandgate_save_size(silo, &size));
    state = malloc(size);
    if (state == NULL) {
        return 1;
    }
    check(silo, sandgate_save(silo, state, size, &size));
    printf("saved %lu bytes\n", (unsigned long)size);
    wide = run(silo, 1.0, 0.1);
    check(silo, sandgate_restore(silo, state, size));
    narrow = run(silo, 0.25, 0.1);
    check(silo, sandgate_restore(silo, state, size));
    again = run(silo, 1.0, 0.1);
    printf("level: %.1f mm with an open gate, %.1f mm with a narrow one\n", 1000.0 * wide, 1000.0 * narrow);
    if (wide != again) {
        fprintf(stderr, "the same steps from the same state gave %.17g and %.17g m\n", wide, again);
        return 1;
    }

    /* A refused call says why and changes nothing. */
    check(silo, sandgate_set_logger(silo, complain, stdout));
    if (sandgate_step(silo, 0.0, 0.01, NULL) != SANDGATE_BAD_ARGUMENT) {
        return 1;
    }
    check(silo, sandgate_terminate(silo));
    free(state);
    sandgate_free(silo);
    return 0;
}
