//! Files that are written from the tables of documents are as these say.

#[path = "../examples/schema.rs"]
#[expect(dead_code, reason = "tests compare, and write nothing")]
mod schema;

#[test]
fn files_are_as_the_tables_say() {
    for (path, text) in schema::files(300) {
        assert!(std::fs::read_to_string(&path).unwrap() == text, "{path} differs; run `make schema`");
    }
}
