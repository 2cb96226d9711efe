[(rule) (example) (topics_item) (provisions_item) (vocabulary_file)] @fold
