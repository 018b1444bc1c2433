// Nothing: the precompiled headers of the tests need a file that they belong to.
