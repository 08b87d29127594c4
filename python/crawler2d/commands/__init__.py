"""The commands of the package: each file has the options and the function of one."""
