/*
 * Spells the type of a C function as text in which only what the calling convention sees counts: sizes, kinds, and
 * for pointers what they point to and whether it may be written. The test compares this with the Rust side.
 *
 *   i1 i4 i8   integer, enumeration or bool of so many bytes      f4 f8   floating point
 *   p(X)       pointer to X      pc(X)   pointer to const X      p(o)    to anything opaque, const or not
 *   v          void (as a result)
 */
#include <cstddef>
#include <cstdio>
#include <string>
#include <type_traits>

template <class T> std::string spell();

template <class T> std::string spell_pointee() {
    using Bare = std::remove_const_t<T>;
    if constexpr (std::is_void_v<Bare> || std::is_class_v<Bare> || std::is_function_v<T>)
        return "o";
    else
        return spell<Bare>();
}

template <class T> std::string spell() {
    if constexpr (std::is_void_v<T>)
        return "v";
    else if constexpr (std::is_pointer_v<T>) {
        using To = std::remove_pointer_t<T>;
        if (spell_pointee<To>() == "o")
            return "p(o)";
        return (std::is_const_v<To> ? "pc(" : "p(") + spell_pointee<To>() + ")";
    } else if constexpr (std::is_floating_point_v<T>)
        return "f" + std::to_string(sizeof(T));
    else {
        static_assert(std::is_integral_v<T> || std::is_enum_v<T>, "a type this file does not know");
        return "i" + std::to_string(sizeof(T));
    }
}

template <class R, class... A> void print(const char *name, R (*)(A...)) {
    std::string text;
    ((text += text.empty() ? spell<A>() : "," + spell<A>()), ...);
    std::printf("%s(%s)->%s\n", name, text.c_str(), spell<R>().c_str());
}

/* Structures that cross the border; the same numbers stand in a test of the Rust side. */
static_assert(sizeof(fmi2CallbackFunctions) == 40, "");
static_assert(offsetof(fmi2CallbackFunctions, componentEnvironment) == 32, "");
static_assert(sizeof(sandgate_variable) == 96, "");
static_assert(offsetof(sandgate_variable, length) == 56, "");
static_assert(offsetof(sandgate_variable, element_index) == 92, "");
static_assert(sizeof(sandgate_step_report) == 24, "");
static_assert(offsetof(sandgate_step_report, iterations) == 20, "");
static_assert(sizeof(sandgate_ledger) == 32, "");
