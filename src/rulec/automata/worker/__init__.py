"""The process in which compilers run, and the choice of the compiler."""
