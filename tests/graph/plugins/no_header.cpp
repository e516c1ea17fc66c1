int something_else() { return 1; }
