/*
 * A small client of include/sandgate.h: makes a silo from its scene file, opens the gate, steps, reads gauges, saves,
 * goes on, restores and goes on again. The second way must give the same bits as the first.
 *
 *   client SCENE [STEPS]     STEPS before and after saving, 10 unless given
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sandgate.h"

static sandgate_instance *silo;

/* What the logger was told. */
struct told {
    int errors, events;
    char last_error[500];
};

static void note(void *user, const char *category, const char *message) {
    struct told *told = user;
    if (strcmp(category, "logStatusError") == 0) {
        told->errors += 1;
        snprintf(told->last_error, sizeof told->last_error, "%s", message);
    } else {
        told->events += 1;
    }
}

static void check(int32_t status, const char *what) {
    if (status != SANDGATE_OK) {
        fprintf(stderr, "%s: status %d: %s\n", what, (int)status, sandgate_last_error(silo));
        exit(1);
    }
}

static uint32_t find(const char *name) {
    uint32_t reference = 0;
    check(sandgate_variable_by_name(silo, name, &reference), name);
    return reference;
}

/* Steps `count` times from `t`; every opening is a multiple of 1/8. Returns the time reached. */
static double run(double t, int count) {
    const double h = 1.0 / 256.0;
    const uint32_t opening = find("gate.main.opening");
    int k;
    for (k = 0; k < count; ++k) {
        const double wanted = fmin(1.0, t * 8.0);
        sandgate_step_report report;
        check(sandgate_set(silo, &opening, 1, &wanted, 1), "set");
        check(sandgate_step(silo, t, h, &report), "step");
        if (report.time != t + h || report.substeps == 0) {
            fprintf(stderr, "the step ended at %.17g, not at %.17g\n", report.time, t + h);
            exit(1);
        }
        t = report.time;
    }
    return t;
}

int main(int argc, char **argv) {
    char error[2000];
    char first[65], second[65];
    sandgate_variable row;
    sandgate_ledger ledger;
    double depth, t, nan_value = NAN;
    uint32_t level, opening, i;
    size_t size = 0, written = 0;
    uint8_t *bytes;
    struct told told = {0, 0, ""};
    const uint32_t wanted = SANDGATE_CAN_GO_BACK | SANDGATE_CAN_VARY_STEPS | SANDGATE_CAN_RUN_IN_PARALLEL
                            | SANDGATE_CAN_USE_THREADS | SANDGATE_CAN_LOG;
    const int steps = argc == 3 ? atoi(argv[2]) : 10;

    if (argc < 2 || argc > 3 || steps < 1 || sandgate_abi_version() != SANDGATE_ABI_VERSION) {
        fprintf(stderr, "usage: client SCENE [STEPS], with the library that belongs to the header\n");
        return 2;
    }
    if (sandgate_create("name = 3", "inline", error, sizeof error) != NULL || strstr(error, "inline") == NULL) {
        fprintf(stderr, "a bad scene was not refused by name: %s\n", error);
        return 1;
    }
    silo = sandgate_create_from_file(argv[1], error, sizeof error);
    if (silo == NULL) {
        fprintf(stderr, "%s\n", error);
        return 1;
    }
    for (i = 0; i < sandgate_variable_count(silo); ++i) {
        check(sandgate_variable_info(silo, i, &row), "info");
        if (row.reference != i || row.name[0] == 0 || row.description[0] == 0 || row.length == 0) {
            fprintf(stderr, "row %u is not complete\n", (unsigned)i);
            return 1;
        }
    }
    if ((sandgate_capabilities() & wanted) != wanted) {
        fprintf(stderr, "capabilities %u lack some of %u\n", (unsigned)sandgate_capabilities(), (unsigned)wanted);
        return 1;
    }
    level = find("gauge.level.depth");
    opening = find("gate.main.opening");

    check(sandgate_set_threads(silo, 2), "threads");
    check(sandgate_set_logger(silo, note, &told), "logger");
    check(sandgate_initialize(silo, 0.0, INFINITY), "initialize");
    if (sandgate_step(silo, 0.5, 0.1, NULL) != SANDGATE_BAD_ARGUMENT || sandgate_last_error(silo)[0] == 0
        || sandgate_set(silo, &opening, 1, &nan_value, 1) != SANDGATE_BAD_ARGUMENT
        || sandgate_enter_initialization(silo, 0.0, INFINITY) != SANDGATE_NOT_NOW
        || sandgate_get(silo, &level, 1, NULL, 1) != SANDGATE_BAD_ARGUMENT
        || sandgate_restore(silo, (const uint8_t *)"rubbish", 7) != SANDGATE_BAD_STATE) {
        fprintf(stderr, "a wrong call was not refused: %s\n", sandgate_last_error(silo));
        return 1;
    }

    if (told.errors != 5 || strcmp(told.last_error, sandgate_last_error(silo)) != 0) {
        fprintf(stderr, "the logger was told of %d refusals, last of: %s\n", told.errors, told.last_error);
        return 1;
    }
    told.events = 0;

    t = run(0.0, steps);
    if (told.errors != 5 || told.events < steps) {
        fprintf(stderr, "the logger was told of %d events in %d steps\n", told.events, steps);
        return 1;
    }
    told.events = 0;
    check(sandgate_set_logger(silo, NULL, NULL), "no logger");
    check(sandgate_save_size(silo, &size), "save size");
    bytes = malloc(size);
    if (bytes == NULL) {
        return 1;
    }
    check(sandgate_save(silo, bytes, size, &written), "save");
    run(t, steps);
    if (told.events != 0) {
        fprintf(stderr, "the logger is still told\n");
        return 1;
    }
    check(sandgate_state_hash(silo, first), "hash");

    check(sandgate_reset(silo), "reset");
    check(sandgate_restore(silo, bytes, written), "restore");
    check(sandgate_set_threads(silo, 1), "threads");
    run(t, steps);
    check(sandgate_state_hash(silo, second), "hash");
    if (strcmp(first, second) != 0) {
        fprintf(stderr, "restored run differs: %s, %s\n", first, second);
        return 1;
    }

    check(sandgate_get(silo, &level, 1, &depth, 1), "get");
    check(sandgate_get_ledger(silo, &ledger), "ledger");
    if (ledger.initial + ledger.inflow - ledger.outflow != ledger.present || !(depth > 0.0)) {
        fprintf(stderr, "mass %g + %g - %g, present %g; depth %g\n", ledger.initial, ledger.inflow, ledger.outflow,
                ledger.present, depth);
        return 1;
    }
    check(sandgate_terminate(silo), "terminate");
    printf("depth %.17g m, state %s\n", depth, second);
    free(bytes);
    sandgate_free(silo);
    sandgate_free(NULL);
    return 0;
}
