#pragma once

// Sine, arc tangent, exponential and their like, compiled into the program. The C library chooses
// among several versions of them by the processor that it runs on, whose last bits differ, and
// another C library has others again; a fold that may go either way then goes another way on
// another machine.
//
// Nobody calls these by name: after each of our libraries is made, all that it calls of the C
// library's mathematics is given these names (cmake/elementary_functions.cmake), whoever calls it:
// Eigen, ufbx and the templates of the standard library too. A test reads the names that the
// finished program asks for (tests/interop/same_on_any_processor_judge.py).
//
// Errors are less than 3 units in the last place. Zeros, infinities and
// what is not a number are treated as in the C library; errno is never set.

extern "C" {
double paperbake_sin(double);
double paperbake_cos(double);
void paperbake_sincos(double, double* sine, double* cosine);
double paperbake_tan(double);
double paperbake_asin(double);
double paperbake_acos(double);
double paperbake_atan(double);
double paperbake_atan2(double y, double x);
double paperbake_exp(double);
double paperbake_log(double);
double paperbake_pow(double, double);
}
