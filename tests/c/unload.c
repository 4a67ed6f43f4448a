/*
 * A program that loads the library, uses a log and two threads, and unloads it: nothing of it stays mapped, though the thread
 * that did all that goes on.
 *
 *   unload LIBRARY SCENE LOG
 */
#define _POSIX_C_SOURCE 200809L
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sandgate.h"

static void *library;

/* ISO C has no way from void * to a function; POSIX says that this one works. */
static void find(const char *name, void *function) {
    void *found = dlsym(library, name);
    if (found == NULL) {
        fprintf(stderr, "%s: %s\n", name, dlerror());
        exit(1);
    }
    memcpy(function, &found, sizeof found);
}

static int mapped(const char *path) {
    char line[4096];
    int found = 0;
    FILE *maps = fopen("/proc/self/maps", "r");
    if (maps == NULL) {
        perror("/proc/self/maps");
        exit(1);
    }
    while (fgets(line, sizeof line, maps) != NULL) {
        found |= strstr(line, path) != NULL;
    }
    fclose(maps);
    return found;
}

static void check(int32_t status, const char *what) {
    if (status != SANDGATE_OK) {
        fprintf(stderr, "%s: status %d\n", what, (int)status);
        exit(1);
    }
}

static void run(const char *scene, const char *log) {
    sandgate_instance *(*create)(const char *, char *, size_t);
    int32_t (*set_threads)(sandgate_instance *, uint32_t);
    int32_t (*by_name)(const sandgate_instance *, const char *, uint32_t *);
    int32_t (*set_text)(sandgate_instance *, uint32_t, const char *);
    int32_t (*initialize)(sandgate_instance *, double, double);
    int32_t (*step)(sandgate_instance *, double, double, sandgate_step_report *);
    int32_t (*terminate)(sandgate_instance *);
    void (*destroy)(sandgate_instance *);
    const double h = 1.0 / 256.0;
    char error[1000];
    uint32_t path;
    sandgate_instance *silo;
    int k;
    find("sandgate_create_from_file", &create);
    find("sandgate_set_threads", &set_threads);
    find("sandgate_variable_by_name", &by_name);
    find("sandgate_set_text", &set_text);
    find("sandgate_initialize", &initialize);
    find("sandgate_step", &step);
    find("sandgate_terminate", &terminate);
    find("sandgate_free", &destroy);
    silo = create(scene, error, sizeof error);
    if (silo == NULL) {
        fprintf(stderr, "%s\n", error);
        exit(1);
    }
    check(set_threads(silo, 2), "set_threads");
    check(by_name(silo, "log.path", &path), "log.path");
    check(set_text(silo, path, log), "set_text");
    check(initialize(silo, 0.0, INFINITY), "initialize");
    for (k = 0; k < 3; ++k) {
        check(step(silo, k * h, h, NULL), "step");
    }
    check(terminate(silo), "terminate");
    destroy(silo);
}

int main(int count, char **arguments) {
    if (count != 4) {
        fprintf(stderr, "unload LIBRARY SCENE LOG\n");
        return 2;
    }
    library = dlopen(arguments[1], RTLD_NOW | RTLD_LOCAL);
    if (library == NULL) {
        fprintf(stderr, "%s\n", dlerror());
        return 1;
    }
    if (!mapped(arguments[1])) {
        fprintf(stderr, "%s: not in /proc/self/maps\n", arguments[1]);
        return 1;
    }
    run(arguments[2], arguments[3]);
    dlclose(library);
    if (mapped(arguments[1])) {
        fprintf(stderr, "%s: still mapped\n", arguments[1]);
        return 1;
    }
    return 0;
}
