/* Does not compile, on purpose. */
#error "a test that cannot be built must make `make test` fail"
