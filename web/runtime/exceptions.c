/* SPDX-FileCopyrightText: 2026 The Morula authors */
/* SPDX-License-Identifier: Apache-2.0 */
#include <stddef.h>

/* The tag of C++ exceptions, which every throw and catch of the module names: its payload is a pointer. */
__asm__(
    ".globl __cpp_exception\n"
    ".tagtype __cpp_exception i32\n"
    "__cpp_exception:\n");

/* Names of types in the message of std::terminate stay mangled: the demangler is larger than the whole runtime. -2: the
 * name is not demangled. */
char* __cxa_demangle(const char* name, char* buffer, size_t* size, int* status) {
  (void)name, (void)buffer, (void)size;
  if (status != NULL) *status = -2;
  return NULL;
}

/* The module has one thread, which ends with the program. */
int __cxa_atexit(void (*destroy)(void*), void* object, void* program);
int __cxa_thread_atexit(void (*destroy)(void*), void* object, void* program) {
  return __cxa_atexit(destroy, object, program);
}
